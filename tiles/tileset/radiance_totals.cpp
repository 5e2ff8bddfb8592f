#include "tiles/tileset/radiance_totals.h"

#include <algorithm>
#include <deque>
#include <numeric>

#include "codec/radiance/radiance_layer.h"
#include "tiles/tileset/subtree.h"

namespace citystream::tiles::tileset {
namespace {

bool has_children(const Manifest& manifest, const Subtree& subtree, const TileRecord& tile) {
    const auto is_child = [&](const TileAddress& other) {
        return other.level == tile.address.level + 1 && other.x / 2 == tile.address.x && other.y / 2 == tile.address.y;
    };
    if (tile.address.level + 1 >= manifest.levels) return false;
    return std::any_of(subtree.tiles.begin(), subtree.tiles.end(),
                       [&](const TileRecord& other) { return is_child(other.address); }) ||
           std::any_of(subtree.child_subtrees.begin(), subtree.child_subtrees.end(), is_child);
}

Status add_tile(const archive::ArchiveReader& reader, const TileRecord& tile, bool is_leaf, RadianceTotals& totals) {
    const auto steps = tile.steps(Layer::kRadiance);
    if (steps.empty()) return Done{};
    const std::string path = layer_path(Layer::kRadiance, tile.address);
    const auto bytes = reader.find(path);
    if (steps[0].end > bytes.size()) return Error{path + ": step 0 lies outside the entry"};
    const auto receivers = codec::radiance::read_receiver_count(bytes.first(steps[0].end), steps[0].decoded_bytes);
    if (!receivers) return Error{path + ": " + receivers.error().text()};
    const auto transport = codec::radiance::read_radiance_transport(bytes.first(steps[0].end));
    if (!transport) return Error{path + ": " + transport.error().text()};
    ++totals.transport_tiles[static_cast<size_t>(*transport)];
    RadianceTotals::Level& level = totals.levels[tile.address.level];
    ++level.tiles;
    level.receivers += *receivers;
    level.wire_bytes += steps.back().end;
    totals.leaf_receivers += is_leaf ? *receivers : 0;
    // Tiles before have no more than they have.
    if (totals.prefixes.size() < steps.size())
        totals.prefixes.resize(steps.size(),
                               totals.prefixes.empty() ? RadianceTotals::Prefix{} : totals.prefixes.back());
    for (size_t i = 0; i < totals.prefixes.size(); ++i) {
        const StepRecord& last = steps[std::min(i, steps.size() - 1)];
        totals.prefixes[i].wire_bytes += last.end;
        totals.prefixes[i].error = std::max(totals.prefixes[i].error, last.error);
    }
    return Done{};
}

}  // namespace

uint64_t tile_bytes(const Manifest& manifest) {
    return std::accumulate(manifest.wire_bytes.begin(), manifest.wire_bytes.end(), uint64_t{0});
}

double radiance_percent(const RadianceTotals& totals, const Manifest& manifest) {
    const uint64_t all = tile_bytes(manifest);
    return all == 0 ? 0 : 100 * static_cast<double>(totals.wire_bytes) / static_cast<double>(all);
}

Result<RadianceTotals> radiance_totals(const archive::ArchiveReader& reader, const Manifest& manifest) {
    RadianceTotals totals;
    if (!manifest.has_layer[static_cast<size_t>(Layer::kRadiance)]) return totals;
    totals.levels.resize(manifest.levels);
    std::deque<TileAddress> open = {TileAddress{}};
    for (; !open.empty(); open.pop_front()) {
        const std::string path = subtree_path(open.front());
        const auto subtree = parse_subtree(reader.find(path), open.front(), manifest);
        if (!subtree) return Error{path + ": " + subtree.error().text()};
        for (const TileRecord& tile : subtree->tiles) {
            const bool is_leaf = !has_children(manifest, *subtree, tile);
            if (const Status added = add_tile(reader, tile, is_leaf, totals); !added) return added.error();
        }
        open.insert(open.end(), subtree->child_subtrees.begin(), subtree->child_subtrees.end());
    }
    for (const RadianceTotals::Level& level : totals.levels) {
        totals.tiles += level.tiles;
        totals.receivers += level.receivers;
        totals.wire_bytes += level.wire_bytes;
    }
    return totals;
}

}  // namespace citystream::tiles::tileset
