// A small city in memory with every entry of an archive: a full quadtree whose tiles have mesh, atlas and (leaves)
// facades.
#pragma once

#include <algorithm>
#include <bit>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "client/select/camera.h"
#include "client/select/chart_dictionary.h"
#include "client/select/facade_dictionary.h"
#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/page_layer.h"
#include "codec/atlas/shared_chart.h"
#include "codec/bits/zstd_frame.h"
#include "codec/facade/facade_layer.h"
#include "codec/facade/facade_wire.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/radiance/radiance_layer.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client::test {

using tiles::tileset::Layer;
using tiles::tileset::Manifest;
using tiles::tileset::StepRecord;
using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;

struct SyntheticOptions {
    uint32_t levels = 4;
    uint32_t subtree_levels = 2;
    double origin_x = 1000 * 128, origin_y = 2000 * 128;
    uint32_t chart_size = 64;
    bool facades = true;
    uint32_t map_width = 40;          ///< texels of the narrowest map
    bool subtree_bytes_known = true;  ///< false: a manifest that does not say how large subtrees get
    uint32_t shared_charts = 0;       ///< in the dictionary: every tile shows three of them beside one of its own
    bool chart_strips = false;        ///< meshes show charts 0 to 3 from south to north, not 0 and 1 in turn
    bool pages = false;               ///< atlases in pages instead of charts
    /// What becomes of the page atlas of one tile before it is written.
    std::pair<TileAddress, std::function<void(LayerSteps&)>> change_atlas;
    bool rough_maps = false;  ///< payloads of a kilobyte and more instead of some tens of bytes
    uint32_t light = 0;       ///< tiles have radiance layers of so many receivers across, of 4 x 4 texels a face
    /// What becomes of the radiance layer of one tile before it is written.
    std::pair<TileAddress, std::function<void(std::vector<codec::radiance::RadianceLayerStep>&)>> change_light;
};

class SyntheticCity {
  public:
    explicit SyntheticCity(const SyntheticOptions& options = {}) : options_(options) {
        manifest.title = "synthetic";
        manifest.origin = {to_grid(options.origin_x), to_grid(options.origin_y), 0};
        manifest.root_side_log2 = 10;
        manifest.levels = options.levels;
        manifest.subtree_levels = options.subtree_levels;
        manifest.extent.max = {1024, 1024, 40};
        manifest.root_geometric_error = 100;
        manifest.has_layer = {true, options.facades, true, options.light > 0};
        if (options.light > 0) manifest.radiance_texels_across = kLightTexels;
        if (options.facades) write_maps();
        if (options.shared_charts > 0) write_charts();
        write_subtrees({});
        manifest.tiles = tiles.size();
        for (const auto& [path, bytes] : entries) {
            const bool subtree = options.subtree_bytes_known && path.starts_with("subtrees/");
            if (subtree) {
                manifest.greatest_subtree_bytes = std::max<uint64_t>(manifest.greatest_subtree_bytes, bytes.size());
            }
        }
        const std::string json = write_tileset_json(manifest);
        put("tileset.json", std::as_bytes(std::span(json)));
    }

    /// A camera over the city, metres from its minimum corner.
    Camera camera(double x, double y, double z, double yaw, double pitch, double fov = 60) const {
        CameraSample sample{0, options_.origin_x + x, options_.origin_y + y, z, yaw, pitch, fov};
        return Camera::from_sample(sample, 640, 480);
    }
    const TileRecord& tile(TileAddress address) const { return tiles.at(address); }
    std::array<double, 2> origin() const { return {options_.origin_x, options_.origin_y}; }

    Manifest manifest;
    std::map<std::string, std::vector<std::byte>> entries;
    std::map<TileAddress, TileRecord> tiles;
    std::vector<tiles::tileset::FacadeMapRecord> maps;
    std::map<TileAddress, std::vector<uint32_t>> maps_of_tile;
    std::map<TileAddress, std::vector<codec::facade::Placement>> placements_of_tile;
    std::map<MapPiece, std::vector<uint32_t>> words_of_piece;
    std::vector<tiles::tileset::ChartRecord> charts;
    std::vector<LayerSteps> steps_of_chart;
    std::map<TileAddress, std::vector<codec::atlas::SharedChartUse>> charts_of_tile;

  private:
    static constexpr uint32_t kLightTexels = 4;

    void put(const std::string& path, std::span<const std::byte> bytes) {
        entries[path].assign(bytes.begin(), bytes.end());
    }

    std::vector<std::byte> frame_of(std::span<const uint32_t> words) {
        return codec::bits::compress_frame(std::as_bytes(words), 3);
    }

    struct WireStep {
        std::vector<std::byte> wire;
        uint32_t decoded_bytes;
        float error;
    };
    void write_layer(TileRecord& record, Layer layer, const LayerSteps& steps) {
        std::vector<WireStep> wire;
        for (const LayerStep& step : steps)
            wire.push_back({frame_of(step.words), static_cast<uint32_t>(4 * step.words.size()), step.error});
        write_steps(record, layer, wire);
    }

    void write_steps(TileRecord& record, Layer layer, const std::vector<WireStep>& steps) {
        std::vector<std::byte> entry;
        for (const WireStep& step : steps) {
            entry.insert(entry.end(), step.wire.begin(), step.wire.end());
            record.steps(layer).push_back({entry.size(), step.decoded_bytes, step.error,
                                           tiles::tileset::checksum_of(step.wire.data(), step.wire.size())});
        }
        const auto index = static_cast<size_t>(layer);
        manifest.wire_bytes[index] += entry.size();
        put(layer_path(layer, record.address), entry);
    }

    /// A wall with a recess `columns` texels wide, or one where every texel is another.
    codec::facade::RunGrid wall_with_recess(uint32_t width, uint32_t columns) const {
        codec::facade::FacadeMatrices image;
        image.width = width;
        image.height = 30;
        image.displacement_mm.assign(size_t{width} * image.height, 0);
        image.material.assign(size_t{width} * image.height, 0);
        for (uint32_t y = 10; y < 20; ++y) {
            for (uint32_t x = 5; x < 5 + columns; ++x) image.displacement_mm[y * width + x] = -150;
        }
        uint32_t state = width * 64 + columns;
        for (size_t i = 0; options_.rough_maps && i < image.displacement_mm.size(); ++i) {
            state = state * 1664525u + 1013904223u;
            image.displacement_mm[i] = static_cast<int16_t>(-150 + static_cast<int>(state >> 25));
        }
        return *codec::facade::make_run_grid(image);
    }

    /// Map i has 1 + i % 3 levels: the finest ones of three with texels of 12, 4 and 1 cm.
    void write_maps() {
        constexpr std::array<uint16_t, 3> kTexels = {12, 4, 1};
        std::vector<std::byte> entry;
        for (uint32_t i = 0; i < 24; ++i) {
            tiles::tileset::FacadeMapRecord record;
            record.width = static_cast<uint16_t>(options_.map_width + i);
            record.height = 30;
            record.depth_min_mm = -150;
            for (uint32_t k = 2 - i % 3; k < 3; ++k) {
                const auto map =
                    codec::facade::encode_shipped_map(wall_with_recess(record.width, i / kTexels[k] * kTexels[k]));
                entry.insert(entry.end(), map.wire.begin(), map.wire.end());
                auto& level = record.level[record.level_count++];
                level.end = entry.size();
                level.resident_bytes = static_cast<uint32_t>(4 * map.words.size());
                level.checksum = static_cast<uint32_t>(tiles::tileset::checksum_of(map.wire.data(), map.wire.size()));
                level.texel_cm = kTexels[k];
                level.displacement_error = k < 2 ? 0.15f : 0.0f;
                words_of_piece[map_piece(i, record.level_count - 1)] = map.words;
            }
            maps.push_back(record);
        }
        put(tiles::tileset::kFacadeMapsPath, entry);
        put(tiles::tileset::kFacadeIndexPath, write_facade_index(maps, manifest));
    }

    void write_mesh(TileRecord& record, int32_t side) {
        codec::mesh::MeshTile mesh;
        constexpr int32_t kCells = 8;
        for (int32_t y = 0; y <= kCells; ++y) {
            for (int32_t x = 0; x <= kCells; ++x) {
                const int32_t wobble = (x * 7919 + y * 104729 + static_cast<int32_t>(record.address.x) * 31) % 9973;
                mesh.vertices.push_back(
                    {{x * side / kCells, y * side / kCells, wobble}, {0, 0, 1}, {x << 16, y << 16}});
            }
        }
        for (uint32_t y = 0; y < kCells; ++y) {
            for (uint32_t x = 0; x < kCells; ++x) {
                const uint32_t a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
                mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
                const uint32_t chart = options_.chart_strips ? y / 2 : x % 2;
                mesh.triangle_chart.insert(mesh.triangle_chart.end(), {chart, chart});
            }
        }
        mesh.dressed_begin = static_cast<uint32_t>(mesh.triangle_chart.size()) - 4;
        codec::mesh::MeshLayerOptions options;
        options.content.finest_error_metres = record.geometric_error;
        std::vector<WireStep> steps;
        for (auto& step : codec::mesh::encode_mesh_layer(mesh, options))
            steps.push_back({std::move(step.wire), step.decoded_bytes, step.error});
        write_steps(record, Layer::kMesh, steps);
    }

    static codec::atlas::ChartImage noise(uint32_t side, double metres_per_texel, uint32_t state) {
        codec::atlas::ChartImage chart;
        chart.width = chart.height = side;
        chart.metres_per_texel = static_cast<float>(metres_per_texel);
        for (uint32_t i = 0; i < 3 * chart.width * chart.height; ++i) {
            state = state * 1664525u + 1013904223u;
            chart.rgb.push_back(static_cast<uint8_t>(state >> 24));
        }
        return chart;
    }

    /// Chart i has 1 + i % 3 levels.
    void write_charts() {
        std::map<ChartPiece, std::vector<std::byte>> payloads;
        for (uint32_t i = 0; i < options_.shared_charts; ++i) {
            const uint32_t side = 64u << i % 3;
            steps_of_chart.push_back(codec::atlas::encode_atlas(std::vector{noise(side, 0, 77 * i)}));
            auto levels = codec::atlas::encode_chart_levels(steps_of_chart.back(), 3);
            tiles::tileset::ChartRecord record;
            record.width = record.height = static_cast<uint16_t>(side);
            record.colour = {static_cast<uint8_t>(i), 20, 30};
            record.level_count = static_cast<uint32_t>(levels.size());
            for (uint32_t level = 0; level < levels.size(); ++level) {
                record.level[level].bytes = static_cast<uint32_t>(levels[level].size());
                payloads[chart_piece(i, level)] = std::move(levels[level]);
            }
            charts.push_back(record);
        }
        put(tiles::tileset::kChartIndexPath, write_chart_index(charts, manifest));
        std::vector<std::byte> entry;
        for (const auto& [piece, payload] : payloads) entry.insert(entry.end(), payload.begin(), payload.end());
        put(tiles::tileset::kChartLevelsPath, entry);
    }

    void write_atlas(TileRecord& record, double side_metres) {
        const double texel = side_metres / 8 / options_.chart_size;
        std::vector<codec::atlas::ChartImage> local;
        for (uint32_t c = 0; c < (options_.shared_charts > 0 ? 1u : 2u); ++c) {
            local.push_back(noise(options_.chart_size, texel, record.address.x * 1000 + record.address.y + c));
        }
        if (options_.pages) {
            LayerSteps steps = *codec::atlas::encode_pages(local);
            if (options_.change_atlas.second && options_.change_atlas.first == record.address)
                options_.change_atlas.second(steps);
            return write_layer(record, Layer::kAtlas, steps);
        }
        auto& shared = charts_of_tile[record.address];
        for (uint32_t i = 0; options_.shared_charts > 0 && i < 3; ++i) {
            const uint32_t number =
                (record.address.x * 7 + record.address.y * 13 + record.address.level + i) % options_.shared_charts;
            // A sum of few powers of two, which the chart table holds as it is.
            shared.push_back({1 + i, number, static_cast<float>(side_metres / 8192 * (1 + i))});
        }
        write_layer(record, Layer::kAtlas, codec::atlas::encode_atlas(local, {}, shared));
    }

    void write_facades(TileRecord& record, int32_t side) {
        codec::facade::FacadeTile facades;
        facades.palettes.resize(1);
        for (auto& slot : facades.palettes[0].slots) slot = {0, 1.0f};
        std::vector<uint32_t>& used = maps_of_tile[record.address];
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t map = (record.address.x * 5 + record.address.y * 3 + i) % static_cast<uint32_t>(maps.size());
            facades.placements.push_back({{0, static_cast<int32_t>(i) * 4096, 0}, {side / 4, 0}, 8192, map, 0});
            used.push_back(map);
        }
        placements_of_tile[record.address] = facades.placements;
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        record.flat_facade_error = 0.15f;
        record.facade_maps = static_cast<uint32_t>(used.size());
        write_layer(record, Layer::kFacade, codec::facade::encode_facades(facades));
    }

    /// Level ground of which every place sees another part of the sky.
    void write_light(TileRecord& record, int32_t side) {
        constexpr uint32_t kUp = 4;
        codec::radiance::RadianceTile tile;
        tile.spacing_log2 = std::min(16U, static_cast<uint32_t>(std::bit_width(static_cast<uint32_t>(side))) - 3);
        tile.visibility.side = kLightTexels;
        uint32_t state = record.address.level * 7919 + record.address.x * 31 + record.address.y;
        for (int32_t j = 0; j < static_cast<int32_t>(options_.light); ++j) {
            for (int32_t i = 0; i < static_cast<int32_t>(options_.light); ++i) {
                tile.places.push_back({kUp, {i, j}, 0, {0, 0}});
                tile.visibility.add_receiver(codec::radiance::frame_of_place(tile.places.back()));
                for (uint32_t s = 0; s < codec::radiance::sample_count(kLightTexels); ++s) {
                    state = state * 1664525u + 1013904223u;
                    if (state >> 30 != 0) tile.visibility.set(tile.visibility.receivers() - 1, s);
                }
            }
        }
        codec::radiance::clear_below_planes(tile.visibility);
        auto encoded = codec::radiance::encode_radiance_layer(tile, 2, state).value();
        if (options_.change_light.second && options_.change_light.first == record.address)
            options_.change_light.second(encoded);
        std::vector<WireStep> steps;
        for (auto& step : encoded) steps.push_back({std::move(step.wire), step.decoded_bytes, step.error});
        write_steps(record, Layer::kRadiance, steps);
    }

    TileRecord make_tile(TileAddress address) {
        TileRecord record;
        record.address = address;
        const double side = manifest.side_metres(address.level);
        record.bounds.min = {address.x * side, address.y * side, 0};
        record.bounds.max = {(address.x + 1) * side, (address.y + 1) * side, 20};
        record.geometric_error = 0.05f;
        for (uint32_t level = address.level; level + 1 < options_.levels; ++level) record.geometric_error *= 5;
        const auto grid_side = static_cast<int32_t>(to_grid(side));
        write_mesh(record, grid_side);
        write_atlas(record, side);
        if (options_.facades && address.level + 1 == options_.levels) write_facades(record, grid_side);
        if (options_.light > 0) write_light(record, grid_side);
        return record;
    }

    void write_subtrees(TileAddress root) {
        tiles::tileset::Subtree subtree;
        subtree.root = root;
        const uint32_t end = std::min(root.level + options_.subtree_levels, options_.levels);
        std::vector<TileAddress> level = {root};
        for (uint32_t l = root.level; l < end; ++l) {
            std::vector<TileAddress> next;
            for (const TileAddress& address : level) {
                subtree.tiles.push_back(make_tile(address));
                tiles.emplace(address, subtree.tiles.back());
                for (uint32_t i = 0; i < 4; ++i) next.push_back(address.child(i));
            }
            level = std::move(next);
        }
        if (end < options_.levels) subtree.child_subtrees = level;
        put(subtree_path(root), write_subtree(subtree, manifest));
        for (const TileAddress& child : subtree.child_subtrees) write_subtrees(child);
    }

    SyntheticOptions options_;
};

}  // namespace citystream::client::test
