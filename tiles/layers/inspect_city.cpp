#include "tiles/layers/inspect_city.h"

#include <fmt/format.h>

#include <deque>
#include <span>

#include "codec/atlas/atlas_form.h"
#include "codec/facade/facade_layer.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/step_wire.h"
#include "tiles/archive/archive.h"
#include "tiles/layers/inspect_charts.h"
#include "tiles/layers/inspect_facades.h"
#include "tiles/layers/inspect_pages.h"
#include "tiles/layers/inspect_radiance.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {
namespace {

using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

/// A layer's prefix, decoded: its words, and how many belong to each step.
struct DecodedLayer {
    std::vector<uint32_t> words;
    std::vector<uint32_t> step_words;
};

class Verifier {
  public:
    Verifier(std::shared_ptr<archive::ArchiveReader> reader, const std::function<void(uint64_t, uint64_t)>& progress)
        : reader_(std::move(reader)), progress_(progress) {}

    std::vector<std::string> run() {
        for (const Error& error : reader_->verify()) damages_.push_back("archive: " + error.text());
        const auto manifest = tileset::parse_tileset_json(reader_->find(tileset::kTilesetPath));
        if (!manifest) {
            say(tileset::kTilesetPath, manifest.error().text());
            return damages_;
        }
        manifest_ = *manifest;
        check_facade_dictionary(*reader_, manifest_,
                                [this](const std::string& where, const std::string& what) { say(where, what); });
        check_chart_dictionary(*reader_, manifest_,
                               [this](const std::string& where, const std::string& what) { say(where, what); });
        check_subtrees();
        if (tiles_ != manifest_.tiles)
            say(tileset::kTilesetPath, fmt::format("lists {} tiles, the subtrees hold {}", manifest_.tiles, tiles_));
        return damages_;
    }

  private:
    void say(const std::string& where, const std::string& what) { damages_.push_back(where + ": " + what); }

    void check_subtrees() {
        std::deque<TileAddress> open = {TileAddress{}};
        for (; !open.empty(); open.pop_front()) {
            const std::string path = tileset::subtree_path(open.front());
            const auto bytes = reader_->find(path);
            const auto subtree = tileset::parse_subtree(bytes, open.front(), manifest_);
            if (!subtree) {
                say(path, subtree.error().text());
                continue;
            }
            const uint64_t greatest = manifest_.greatest_subtree_bytes;
            if (greatest > 0 && bytes.size() > greatest)
                say(path, fmt::format("has {} bytes, tileset.json allows {}", bytes.size(), greatest));
            for (const TileRecord& tile : subtree->tiles) check_tile(tile);
            open.insert(open.end(), subtree->child_subtrees.begin(), subtree->child_subtrees.end());
        }
    }

    void check_tile(const TileRecord& tile) {
        ++tiles_;
        if (progress_) progress_(tiles_, manifest_.tiles);
        const auto atlas = decode(tile, Layer::kAtlas);
        uint32_t charts = tile.steps(Layer::kAtlas).empty() ? 1 : 0;
        if (atlas) {
            const auto facts = codec::atlas::check_atlas(atlas->words, atlas->step_words, manifest_.shared_chart_count);
            if (!facts) say(tileset::layer_path(Layer::kAtlas, tile.address), facts.error().text());
            if (facts) charts = facts->chart_count;
        }
        if (charts == 0) charts = UINT32_MAX >> 8;  // the atlas is damaged and named already: only this check is lost
        check_mesh(tile, charts);
        check_radiance(tile);
        if (const auto facade = decode(tile, Layer::kFacade)) {
            const auto view =
                codec::facade::decode_facades(facade->words, static_cast<uint32_t>(manifest_.facade_map_count), charts);
            if (!view) say(tileset::layer_path(Layer::kFacade, tile.address), view.error().text());
        }
    }

    void check_radiance(const TileRecord& tile) {
        const auto wire = steps_of(tile, Layer::kRadiance);
        if (!wire || wire->empty()) return;
        uint64_t decoded_bytes = 0;
        for (const tileset::StepRecord& step : tile.steps(Layer::kRadiance)) decoded_bytes += step.decoded_bytes;
        const auto words =
            codec::radiance::decode_radiance_layer(*wire, decoded_bytes, codec::radiance::MatrixForm::kRows);
        const std::string path = tileset::layer_path(Layer::kRadiance, tile.address);
        if (!words) return say(path, words.error().text());
        const auto view = codec::radiance::RadianceLayerView::create(*words);
        if (!view) say(path, view.error().text());
    }

    void check_mesh(const TileRecord& tile, uint32_t charts) {
        const auto wire = steps_of(tile, Layer::kMesh);
        if (!wire || wire->empty()) return;
        std::vector<uint32_t> decoded_bytes;
        for (const tileset::StepRecord& step : tile.steps(Layer::kMesh)) decoded_bytes.push_back(step.decoded_bytes);
        const auto mesh = codec::mesh::decode_mesh_layer(*wire, decoded_bytes, charts);
        if (!mesh) say(tileset::layer_path(Layer::kMesh, tile.address), mesh.error().text());
    }

    /// The bytes of a layer's steps; nothing where they are not what the directory says.
    std::optional<std::vector<std::span<const std::byte>>> steps_of(const TileRecord& tile, Layer layer) {
        const std::string path = tileset::layer_path(layer, tile.address);
        const auto bytes = reader_->find(path);
        std::vector<std::span<const std::byte>> out;
        uint64_t begin = 0;
        for (const tileset::StepRecord& step : tile.steps(layer)) {
            if (step.end < begin || step.end > bytes.size())
                return fail(path, fmt::format("step {} lies outside the entry", out.size()));
            out.push_back(bytes.subspan(begin, step.end - begin));
            if (tileset::checksum_of(out.back().data(), out.back().size()) != step.checksum)
                return fail(path, fmt::format("step {}: checksum differs", out.size() - 1));
            begin = step.end;
        }
        if (begin != bytes.size()) return fail(path, "bytes follow the last step");
        return out;
    }

    std::optional<DecodedLayer> decode(const TileRecord& tile, Layer layer) {
        const auto wire = steps_of(tile, layer);
        if (!wire || wire->empty()) return std::nullopt;
        DecodedLayer out;
        for (size_t i = 0; i < wire->size(); ++i) {
            const auto words = codec::decode_step((*wire)[i], tile.steps(layer)[i].decoded_bytes);
            if (!words) {
                say(tileset::layer_path(layer, tile.address), fmt::format("step {}: {}", i, words.error().text()));
                return std::nullopt;
            }
            out.words.insert(out.words.end(), words->begin(), words->end());
            out.step_words.push_back(static_cast<uint32_t>(words->size()));
        }
        return out;
    }

    std::nullopt_t fail(const std::string& where, const std::string& what) {
        say(where, what);
        return std::nullopt;
    }

    std::shared_ptr<archive::ArchiveReader> reader_;
    const std::function<void(uint64_t, uint64_t)>& progress_;
    tileset::Manifest manifest_;
    uint64_t tiles_ = 0;
    std::vector<std::string> damages_;
};

}  // namespace

nlohmann::json manifest_json(const tileset::Manifest& m) {
    const double x = to_metres(m.origin.x), y = to_metres(m.origin.y);
    nlohmann::json out;
    out["title"] = m.title;
    out["epsg"] = m.epsg;
    out["extent"] = {m.extent.min[0] + x, m.extent.min[1] + y, m.extent.min[2],
                     m.extent.max[0] + x, m.extent.max[1] + y, m.extent.max[2]};
    out["buildings"] = m.buildings;
    out["triangles"] = m.triangles;
    out["facades"] = m.facades;
    out["facade_maps"] = m.facade_map_count;
    out["shared_charts"] = m.shared_chart_count;
    out["chart_dictionary_bytes"] = m.chart_index_bytes + m.chart_levels_bytes;
    out["facades_made_up"] = m.facades_made_up;
    out["tiles"] = m.tiles;
    out["levels"] = m.levels;
    out["root_side_metres"] = m.side_metres(0);
    out["build_options"] = m.build_options;
    for (size_t layer = 0; layer < tileset::kLayerCount; ++layer) {
        out["layers"][tileset::kLayerNames[layer]] = {{"wire_bytes", m.wire_bytes[layer]},
                                                      {"decoded_bytes", m.decoded_bytes[layer]}};
    }
    if (m.has_layer[static_cast<size_t>(Layer::kRadiance)]) {
        nlohmann::json& radiance = out["layers"]["radiance"];
        radiance["texels_across"] = m.radiance_texels_across;
        radiance["local_across"] = m.radiance_local_across;
        radiance["lattice_metres"] = m.radiance_lattice_metres;
    }
    return out;
}

Result<nlohmann::json> read_city_info(const std::string& path) {
    const auto reader = archive::ArchiveReader::open(path);
    if (!reader) return reader.error();
    const auto manifest = tileset::parse_tileset_json((*reader)->find(tileset::kTilesetPath));
    if (!manifest) return manifest.error();
    nlohmann::json out = manifest_json(*manifest);
    out["archive_bytes"] = (*reader)->file_size();
    out["entries"] = (*reader)->entries().size();
    if (manifest->facade_map_count > 0) {
        auto facades = facade_dictionary_json(**reader, *manifest);
        if (!facades) return facades.error();
        out["facade_dictionary"] = std::move(facades).value();
    }
    if (manifest->shared_chart_count > 0) {
        auto charts = chart_dictionary_json(**reader, *manifest);
        if (!charts) return charts.error();
        out["chart_dictionary"] = std::move(charts).value();
    }
    if (manifest->pages_or_alpha) {
        auto pages = page_json(**reader, *manifest);
        if (!pages) return pages.error();
        out["atlas_pages"] = std::move(pages).value();
    }
    if (manifest->has_layer[static_cast<size_t>(Layer::kRadiance)]) {
        auto radiance = radiance_json(**reader, *manifest);
        if (!radiance) return radiance.error();
        out["radiance"] = std::move(radiance).value();
    }
    return out;
}

Result<std::vector<std::string>> verify_city(const std::string& path,
                                             const std::function<void(uint64_t, uint64_t)>& progress) {
    auto reader = archive::ArchiveReader::open(path);
    if (!reader) return reader.error();
    return Verifier(std::move(reader).value(), progress).run();
}

}  // namespace citystream::tiles::layers
