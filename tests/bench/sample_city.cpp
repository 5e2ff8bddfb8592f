#include "tests/bench/sample_city.h"

#include <stdlib.h>

#include <deque>
#include <set>

#include "tiles/city/city_input.h"
#include "tiles/city/generator.h"
#include "tiles/layers/build_city.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::bench {

using namespace tiles;

namespace {

Status build(const layers::CitySource& source, const LayerSet& set, const std::string& archive) {
    layers::BuildOptions options;
    options.output = archive;
    options.layers = set;
    city::CityReport report;
    const auto built = layers::build_city(options, source, report);
    if (!built) return built.error();
    return Done{};
}

Error about(const std::string& path, const std::string& why) {
    return {path + ": " + why};
}

Status add_subtrees(SampleCity& city) {
    std::deque<tileset::TileAddress> waiting = {{0, 0, 0}};
    while (!waiting.empty()) {
        const tileset::TileAddress root = waiting.front();
        waiting.pop_front();
        const auto bytes = city.archive->find(tileset::subtree_path(root));
        auto parsed = tileset::parse_subtree(bytes, root, city.manifest);
        if (!parsed) return about(tileset::subtree_path(root), parsed.error().text());
        waiting.insert(waiting.end(), parsed->child_subtrees.begin(), parsed->child_subtrees.end());
        city.subtrees.push_back({bytes, std::move(*parsed)});
    }
    return Done{};
}

}  // namespace

std::vector<const tileset::TileRecord*> SampleCity::leaves() const {
    std::set<tileset::TileAddress> parents;
    for (const auto& subtree : subtrees) {
        for (const auto& tile : subtree.parsed.tiles) {
            if (tile.address.level > 0) parents.insert(tile.address.parent());
        }
    }
    std::vector<const tileset::TileRecord*> leaves;
    for (const auto& subtree : subtrees) {
        for (const auto& tile : subtree.parsed.tiles) {
            if (!parents.contains(tile.address)) leaves.push_back(&tile);
        }
    }
    return leaves;
}

std::span<const std::byte> SampleCity::layer_bytes(const tileset::TileRecord& tile, tileset::Layer layer) const {
    return archive->find(tileset::layer_path(layer, tile.address));
}

Status build_generated(uint32_t buildings, uint64_t seed, const LayerSet& layers, const std::string& archive) {
    city::GeneratorOptions generator;
    generator.buildings = buildings;
    generator.seed = seed;
    return build(
        [&](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
            const city::CitySink& sink) -> Status {
            city::generate_city(generator, header, catalog, report, sink);
            return Done{};
        },
        layers, archive);
}

Status build_from_files(const std::vector<std::string>& files, const LayerSet& layers, const std::string& archive) {
    return build([&](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
                     const city::CitySink& sink) { return city::read_city(files, {}, header, catalog, report, sink); },
                 layers, archive);
}

Result<SampleCity> open_city(const std::string& archive) {
    SampleCity city;
    city.path = archive;
    auto reader = archive::ArchiveReader::open(archive);
    if (!reader) return about(archive, reader.error().text());
    city.archive = std::move(*reader);
    auto manifest = tileset::parse_tileset_json(city.archive->find(tileset::kTilesetPath));
    if (!manifest) return about(archive, manifest.error().text());
    city.manifest = std::move(*manifest);
    const Status added = add_subtrees(city);
    if (!added) return added.error();
    if (city.manifest.facade_map_count > 0) {
        auto maps = tileset::parse_facade_index(city.archive->find(tileset::kFacadeIndexPath), city.manifest);
        if (!maps) return about(archive, maps.error().text());
        city.maps = std::move(*maps);
    }
    if (city.manifest.shared_chart_count > 0) {
        auto charts = tileset::parse_chart_index(city.archive->find(tileset::kChartIndexPath), city.manifest);
        if (!charts) return about(archive, charts.error().text());
        city.charts = std::move(*charts);
    }
    return city;
}

Result<SampleCity> city_of_file(const std::string& file, const LayerSet& layers, const TemporaryFolder& folder) {
    const std::filesystem::path path(file);
    if (path.extension() == ".3tz") return open_city(file);
    const std::string archive = folder / (path.stem().string() + ".3tz");
    const Status built = build_from_files({file}, layers, archive);
    if (!built) return about(file, built.error().text());
    return open_city(archive);
}

}  // namespace citystream::bench
