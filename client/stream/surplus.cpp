#include "client/stream/surplus.h"

#include <algorithm>
#include <vector>

namespace citystream::client {

using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;

namespace {

struct Needs {
    const ViewChoice& view;
    const DirectoryCache& directory;
    const CityKnowledge& knowledge;
    LayerCache& cache;
};

/// Calls visit(entry, steps, bytes in the store, wire bytes) for every layer in steps and its wanted prefix.
template <typename Visit>
void visit_needed_layers(const Needs& needs, const Visit& visit) {
    const auto visit_tile = [&](const SelectedTile& tile) {
        const DirectoryNode& node = needs.directory.node(tile.node);
        for (size_t layer = 0; layer < kLayerCount; ++layer) {
            const uint32_t steps = tile.steps[layer];
            if (steps == 0) continue;
            const Layer kind = static_cast<Layer>(layer);
            visit(needs.cache.at(layer_key(tile.node, kind)), steps,
                  store_bytes(node, needs.knowledge.tiles[tile.node], kind, steps),
                  wire_prefix_bytes(node.record->steps(kind), steps));
        }
    };
    for (const SelectedTile& tile : needs.view.needed()) visit_tile(tile);
    for (const SelectedTile& tile : needs.view.casters().tiles) visit_tile(tile);
    for (const ChartPrefix& chart : needs.view.needed_charts()) {
        visit(needs.cache.at(chart_key(chart.chart)), chart.levels, needs.knowledge.charts.decoded_bytes(chart),
              needs.knowledge.charts.wire_bytes(chart));
    }
}

/// Slots of all that is needed when it is complete, with what is resident beyond the wanted prefixes.
uint64_t needed_slots(const Needs& needs) {
    uint64_t slots = 0;
    visit_needed_layers(needs, [&](const CachedLayer& entry, uint32_t, uint64_t decoded, uint64_t) {
        slots += needs.cache.slots_for(std::max(decoded, entry.store_bytes));
    });
    std::vector<MapPiece> pieces;
    for (const SelectedTile& tile : needs.view.needed())
        pieces.insert(pieces.end(), tile.pieces.begin(), tile.pieces.end());
    std::sort(pieces.begin(), pieces.end());
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    for (const MapPiece piece : pieces)
        slots += needs.cache.slots_for(needs.knowledge.dictionary.resident_bytes(piece));
    return slots;
}

}  // namespace

void trim_surplus(const ViewChoice& view, const DirectoryCache& directory, const CityKnowledge& knowledge,
                  LayerCache& cache, const HostMemory& host) {
    const Needs needs{view, directory, knowledge, cache};
    const SelectionCost& cost = view.selection().cost;
    uint64_t slots = needed_slots(needs);
    uint64_t wire_surplus = 0;
    visit_needed_layers(needs, [&](CachedLayer& entry, uint32_t, uint64_t decoded, uint64_t wire) {
        if (slots > cache.slot_count() && entry.store_bytes > decoded) {
            slots -= cache.slots_for(entry.store_bytes) - cache.slots_for(decoded);
            cache.drop_store(entry);
        }
        if (entry.wire_bytes > wire) wire_surplus += entry.wire_bytes - wire;
    });
    const uint64_t need = cost.wire_bytes + wire_surplus + cost.largest_scratch;
    if (host.fixed + host.in_flight + need <= host.budget) return;
    visit_needed_layers(
        needs, [&](CachedLayer& entry, uint32_t steps, uint64_t, uint64_t) { cache.drop_wire_from(entry, steps); });
}

bool has_host_room(const Selection& selection, const HostMemory& host) {
    constexpr uint64_t kRoom = 1 << 20;
    const uint64_t needed = host.fixed + selection.cost.wire_bytes + selection.cost.largest_scratch;
    return needed + kRoom <= host.budget;
}

}  // namespace citystream::client
