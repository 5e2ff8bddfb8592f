// A city of noise for the tests of archive and directory: a random quadtree with random step tables, and an archive in
// which every step is a real frame.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "codec/bits/zstd_frame.h"
#include "codec/facade/facade_levels.h"
#include "codec/facade/facade_wire.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::tileset {

struct SyntheticCity {
    Manifest manifest;
    std::vector<Subtree> subtrees;
    std::map<std::string, std::vector<std::byte>> entries;  ///< layers, facade maps and index
};

class SyntheticCityMaker {
  public:
    SyntheticCityMaker(uint32_t seed, uint32_t levels, uint32_t subtree_levels) : random_(seed) {
        Manifest& manifest = city_.manifest;
        manifest.title = "Synthetic \"city\" \xC3\xBC";
        manifest.epsg = 25832;
        manifest.root_side_log2 = 10;
        manifest.origin = {to_grid(677'888.0), to_grid(-5'402'880.0), 0};
        manifest.levels = levels;
        manifest.subtree_levels = subtree_levels;
        manifest.extent = {{0.125, 3, -2.5}, {1000.3, 1024, 91.75}};
        manifest.root_geometric_error = 91.7;
        manifest.has_layer = {true, true, true, false};
        manifest.build_options = "--layers mesh,facade,atlas";
    }

    SyntheticCity make() {
        make_facade_maps();
        add_subtree({0, 0, 0});
        Manifest& manifest = city_.manifest;
        manifest.buildings = 17 * manifest.tiles;
        manifest.facades = 3;
        for (const Subtree& subtree : city_.subtrees) {
            const uint64_t bytes = write_subtree(subtree, manifest).size();
            manifest.greatest_subtree_bytes = std::max(manifest.greatest_subtree_bytes, bytes);
        }
        return std::move(city_);
    }

  private:
    uint32_t below(uint32_t limit) { return std::uniform_int_distribution<uint32_t>(0, limit - 1)(random_); }
    uint64_t bits64() { return std::uniform_int_distribution<uint64_t>()(random_); }

    // The root's first children always exist, so that every level is reached.
    bool exists(TileAddress tile) { return (tile.x == 0 && tile.y == 0) || below(5) < 2; }

    void add_subtree(TileAddress root) {
        Subtree subtree;
        subtree.root = root;
        std::vector<TileAddress> row = {root};
        for (uint32_t depth = 0; depth < city_.manifest.subtree_levels && !row.empty(); ++depth) {
            std::vector<TileAddress> below_row;
            for (const TileAddress tile : row) {
                subtree.tiles.push_back(make_tile(tile));
                if (tile.level + 1 >= city_.manifest.levels) continue;
                for (uint32_t i = 0; i < 4; ++i) {
                    if (exists(tile.child(i))) below_row.push_back(tile.child(i));
                }
            }
            row = std::move(below_row);
        }
        subtree.child_subtrees = row;
        city_.manifest.tiles += subtree.tiles.size();
        city_.subtrees.push_back(std::move(subtree));
        for (const TileAddress child : row) add_subtree(child);
    }

    TileRecord make_tile(TileAddress address) {
        TileRecord record;
        record.address = address;
        const double side = city_.manifest.side_metres(address.level);
        const double unit = kMetresPerGridUnit;
        record.bounds.min = {address.x * side + 3 * unit, address.y * side, -2.5 + address.level * unit};
        record.bounds.max = {(address.x + 1) * side, (address.y + 1) * side - unit, 90 - address.level * 0.5};
        record.geometric_error = 20.0F / static_cast<float>(1U << address.level);
        record.base_height = -2560 + static_cast<int64_t>(below(1000));
        for (const Layer layer : {Layer::kMesh, Layer::kFacade, Layer::kAtlas}) {
            if (layer == Layer::kMesh || below(3) > 0) make_layer(record, layer);
        }
        if (!record.steps(Layer::kFacade).empty()) {
            record.flat_facade_error = 0.25F;
            record.facade_maps = 1 + below(3);
        }
        return record;
    }

    void make_layer(TileRecord& record, Layer layer) {
        std::vector<std::byte> entry;
        const uint32_t count = 1 + below(5);
        for (uint32_t i = 0; i < count; ++i) {
            const std::vector<std::byte> raw = make_raw();
            const std::vector<std::byte> frame = codec::bits::compress_frame(raw, 3);
            entry.insert(entry.end(), frame.begin(), frame.end());
            record.steps(layer).push_back({entry.size(), static_cast<uint32_t>(raw.size()),
                                           8.0F / static_cast<float>(1U << i),
                                           checksum_of(frame.data(), frame.size())});
            city_.manifest.decoded_bytes[static_cast<size_t>(layer)] += raw.size();
        }
        city_.manifest.wire_bytes[static_cast<size_t>(layer)] += entry.size();
        city_.entries[layer_path(layer, record.address)] = std::move(entry);
    }

    std::vector<std::byte> make_raw() {
        std::vector<std::byte> raw(4 * (1 + below(100)));
        for (std::byte& byte : raw) byte = static_cast<std::byte>(below(7));
        return raw;
    }

    void make_facade_maps() {
        std::vector<FacadeMapRecord> records;
        std::vector<std::byte> maps;
        for (uint32_t i = 0; i < 3; ++i) {
            const codec::facade::RunGrid exact = make_grid(i);
            FacadeMapRecord record;
            record.width = static_cast<uint16_t>(exact.width());
            record.height = static_cast<uint16_t>(exact.height());
            record.depth_min_mm = static_cast<int16_t>(exact.depths().min_mm);
            record.depth_max_mm = static_cast<int16_t>(exact.depths().max_mm);
            if (i > 0) add_level(record, codec::facade::coarsen(exact, 16), 16, 0.3F, maps);
            add_level(record, exact, 1, 0, maps);
            records.push_back(record);
        }
        city_.entries[kFacadeMapsPath] = std::move(maps);
        city_.entries[kFacadeIndexPath] = write_facade_index(records, city_.manifest);
    }

    codec::facade::RunGrid make_grid(uint32_t i) {
        codec::facade::RunGrid grid{{0, 40, 100 + i, 300}, {0, 25, 90}, {}};
        for (uint32_t cell = 0; cell < 6; ++cell)
            grid.labels.push_back(codec::facade::make_label(static_cast<int32_t>(below(300)) - 150, cell % 3));
        return grid;
    }

    static void add_level(FacadeMapRecord& record, const codec::facade::RunGrid& grid, uint16_t texel_cm, float error,
                          std::vector<std::byte>& maps) {
        const codec::facade::ShippedMap shipped = codec::facade::encode_shipped_map(grid);
        maps.insert(maps.end(), shipped.wire.begin(), shipped.wire.end());
        record.level[record.level_count++] = {
            maps.size(), static_cast<uint32_t>(4 * shipped.words.size()),
            static_cast<uint32_t>(checksum_of(shipped.wire.data(), shipped.wire.size())), texel_cm, error};
    }

    std::mt19937 random_;
    SyntheticCity city_;
};

inline SyntheticCity make_synthetic_city(uint32_t seed, uint32_t levels, uint32_t subtree_levels) {
    return SyntheticCityMaker(seed, levels, subtree_levels).make();
}

inline Status write_synthetic_city(const SyntheticCity& city, const std::string& path) {
    auto writer = archive::ArchiveWriter::create(path);
    if (!writer) return writer.error();
    const std::string tileset = write_tileset_json(city.manifest);
    if (auto status = (*writer)->add(kTilesetPath, std::as_bytes(std::span(tileset))); !status) return status;
    for (const Subtree& subtree : city.subtrees) {
        const std::vector<std::byte> bytes = write_subtree(subtree, city.manifest);
        if (auto status = (*writer)->add(subtree_path(subtree.root), bytes); !status) return status;
    }
    for (const auto& [name, bytes] : city.entries) {
        if (auto status = (*writer)->add(name, bytes); !status) return status;
    }
    return (*writer)->finish();
}

}  // namespace citystream::tiles::tileset
