#include "client/load/city_index.h"

#include <charconv>
#include <mutex>
#include <utility>

#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client {

using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;

std::optional<TileAddress> address_in_path(std::string_view path, std::string_view folder) {
    if (!path.starts_with(folder)) return std::nullopt;
    path.remove_prefix(folder.size());
    TileAddress address;
    for (uint32_t* part : {&address.level, &address.x, &address.y}) {
        if (!path.starts_with('/')) return std::nullopt;
        const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), *part);
        if (error != std::errc()) return std::nullopt;
        path.remove_prefix(static_cast<size_t>(end - path.data()));
    }
    if (!path.starts_with('.')) return std::nullopt;
    return address;
}

void CityIndex::learn(const std::string& path, std::span<const std::byte> bytes) {
    const auto subtree = address_in_path(path, "subtrees");
    const bool tileset = path == tiles::tileset::kTilesetPath, facades = path == tiles::tileset::kFacadeIndexPath,
               charts = path == tiles::tileset::kChartIndexPath;
    if (!subtree && !tileset && !facades && !charts) return;
    const std::unique_lock lock(mutex_);
    if (known_paths_.contains(path)) return;
    if (tileset) {
        auto manifest = tiles::tileset::parse_tileset_json(bytes);
        if (!manifest) return;
        manifest_ = std::move(*manifest);
    } else if (!manifest_) {
        return;
    } else if (subtree) {
        learn_subtree(*subtree, bytes);
    } else if (charts) {
        auto records = tiles::tileset::parse_chart_index(bytes, *manifest_);
        if (!records) return;
        charts_.learn(std::move(*records));
    } else {
        auto maps = tiles::tileset::parse_facade_index(bytes, *manifest_);
        if (!maps) return;
        dictionary_.learn(std::move(*maps));
    }
    known_paths_.insert(path);
}

void CityIndex::learn_subtree(TileAddress root, std::span<const std::byte> bytes) {
    auto subtree = tiles::tileset::parse_subtree(bytes, root, *manifest_);
    if (!subtree) return;
    subtrees_.push_back(std::move(*subtree));
    for (const TileRecord& record : subtrees_.back().tiles) tiles_[record.address] = &record;
}

const TileRecord* CityIndex::find(const TileDraw& draw) const {
    const std::shared_lock lock(mutex_);
    const auto found = tiles_.find(draw.address);
    return found == tiles_.end() ? nullptr : found->second;
}

uint64_t CityIndex::map_bytes(MapPiece piece) const {
    const std::shared_lock lock(mutex_);
    return map_of(piece) < dictionary_.size() ? dictionary_.wire_bytes(piece) : 0;
}

uint64_t CityIndex::chart_bytes(const ChartPrefix& prefix) const {
    const std::shared_lock lock(mutex_);
    return prefix.chart < charts_.size() ? charts_.wire_bytes(prefix) : 0;
}

}  // namespace citystream::client
