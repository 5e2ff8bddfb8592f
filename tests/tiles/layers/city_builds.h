// Cities of tests of the builder: from sources in memory to archives in a folder of the test's own, and layers read
// back.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/step_wire.h"
#include "tests/tiles/layers/image_files.h"
#include "tiles/archive/archive.h"
#include "tiles/city/generator.h"
#include "tiles/layers/build_city.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {

class CityBuildTest : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    std::string bytes_of(const std::string& name) const { return folder_.bytes_of(name); }

    /// Options that a test does not change; two threads unless it says otherwise.
    virtual BuildOptions usual_options() const {
        BuildOptions options;
        options.jobs = 2;
        return options;
    }

    Result<BuildSummary> build(const std::string& name, const CitySource& source,
                               const std::function<void(BuildOptions&)>& change = {}) const {
        BuildOptions options = usual_options();
        options.output = path(name);
        if (change) change(options);
        city::CityReport report;
        return build_city(options, source, report);
    }

    ImageFolder folder_;
};

inline CitySource generated(uint32_t buildings, const city::Vec2& origin = {}) {
    return [buildings, origin](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
                               const city::CitySink& sink) -> Status {
        city::GeneratorOptions options;
        options.buildings = buildings;
        options.origin = origin;
        city::generate_city(options, header, catalog, report, sink);
        return Done{};
    };
}

/// An upright wall that faces south and shows its material's image once.
inline city::CityObject image_wall(const std::string& id, const city::Vec2& foot, double width, double height,
                                   uint32_t material) {
    city::CityObject wall;
    wall.id = id;
    wall.kind = city::ObjectKind::kBuilding;
    const auto [x, y] = foot;
    wall.vertices = {{x, y, 0}, {x + width, y, 0}, {x + width, y, height}, {x, y, height}};
    for (const uint32_t middle : {1U, 2U}) {
        city::Triangle triangle;
        triangle.material = material;
        triangle.vertex = {0, middle, middle + 1};
        triangle.texcoord[0] = {0, 0};
        triangle.texcoord[1] = middle == 1 ? city::Vec2{1, 0} : city::Vec2{1, 1};
        triangle.texcoord[2] = middle == 1 ? city::Vec2{1, 1} : city::Vec2{0, 1};
        wall.triangles.push_back(triangle);
    }
    return wall;
}

/// A street of walls of 12 x 8 m, one for each image file.
inline CitySource street_of(const std::vector<std::string>& images) {
    return [images](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                    const city::CitySink& sink) -> Status {
        double x = 0;
        for (const std::string& path : images) {
            catalog.images.push_back({.path = path});
            city::Material material;
            material.image = static_cast<int32_t>(catalog.images.size() - 1);
            ++report.buildings_emitted;
            if (!sink(image_wall("wall of " + path, {x, 0}, 12, 8, catalog.add_material(material)))) break;
            x += 13;
        }
        return Done{};
    };
}

/// An archive with its whole directory.
struct OpenCity {
    std::shared_ptr<archive::ArchiveReader> reader;
    tileset::Manifest manifest;
    std::map<tileset::TileAddress, tileset::TileRecord> tiles;
    uint64_t greatest_subtree_bytes = 0;
};

inline OpenCity open_city(const std::string& path) {
    OpenCity city;
    auto reader = archive::ArchiveReader::open(path);
    EXPECT_TRUE(reader.ok());
    if (!reader) return city;
    city.reader = *reader;
    const auto manifest = tileset::parse_tileset_json(city.reader->find(tileset::kTilesetPath));
    EXPECT_TRUE(manifest.ok());
    if (!manifest) return city;
    city.manifest = *manifest;
    for (std::deque<tileset::TileAddress> open = {tileset::TileAddress{}}; !open.empty(); open.pop_front()) {
        const auto bytes = city.reader->find(tileset::subtree_path(open.front()));
        city.greatest_subtree_bytes = std::max<uint64_t>(city.greatest_subtree_bytes, bytes.size());
        const auto subtree = tileset::parse_subtree(bytes, open.front(), city.manifest);
        EXPECT_TRUE(subtree.ok()) << subtree.error().text();
        if (!subtree) return city;
        for (const tileset::TileRecord& tile : subtree->tiles) city.tiles[tile.address] = tile;
        open.insert(open.end(), subtree->child_subtrees.begin(), subtree->child_subtrees.end());
    }
    return city;
}

inline bool has_children(const OpenCity& city, tileset::TileAddress address) {
    for (uint32_t i = 0; i < 4; ++i) {
        if (city.tiles.count(address.child(i)) != 0) return true;
    }
    return false;
}

/// A tile's mesh layer; without triangles where it has none.
inline codec::mesh::MeshLayer mesh_layer_of(const OpenCity& city, const tileset::TileRecord& record) {
    const auto bytes = city.reader->find(tileset::layer_path(tileset::Layer::kMesh, record.address));
    std::vector<std::span<const std::byte>> wire;
    std::vector<uint32_t> decoded_bytes;
    uint64_t begin = 0;
    for (const tileset::StepRecord& step : record.steps(tileset::Layer::kMesh)) {
        wire.push_back(bytes.subspan(begin, step.end - begin));
        decoded_bytes.push_back(step.decoded_bytes);
        begin = step.end;
    }
    if (wire.empty()) return {};
    auto mesh = codec::mesh::decode_mesh_layer(wire, decoded_bytes, codec::mesh::kAnyMeshChart);
    EXPECT_TRUE(mesh.ok()) << (mesh ? "" : mesh.error().text());
    return mesh ? std::move(*mesh) : codec::mesh::MeshLayer{};
}

/// A tile's triangles.
inline codec::mesh::MeshTile mesh_of(const OpenCity& city, const tileset::TileRecord& record) {
    return codec::mesh::to_tile(mesh_layer_of(city, record).content);
}

/// Words of all steps of a tile's layer that is no mesh, and how many each step has; empty: the tile has none.
struct LayerWords {
    std::vector<uint32_t> words, step_words;
};

inline LayerWords layer_words(const OpenCity& city, const tileset::TileRecord& record, tileset::Layer layer) {
    LayerWords all;
    const auto bytes = city.reader->find(tileset::layer_path(layer, record.address));
    uint64_t begin = 0;
    for (const tileset::StepRecord& step : record.steps(layer)) {
        const auto words = codec::decode_step(bytes.subspan(begin, step.end - begin), step.decoded_bytes);
        EXPECT_TRUE(words.ok()) << words.error().text();
        if (!words) return {};
        all.words.insert(all.words.end(), words->begin(), words->end());
        all.step_words.push_back(static_cast<uint32_t>(words->size()));
        begin = step.end;
    }
    return all;
}

}  // namespace citystream::tiles::layers
