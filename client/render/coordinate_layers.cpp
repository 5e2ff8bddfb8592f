#include "client/render/coordinate_layers.h"

#include "codec/atlas/page_layout.h"

namespace citystream::client {

CoordinateLayers::Coordinates CoordinateLayers::make(const TileDraw& tile, SlotPool& pool) {
    if (tile.mesh == kNoLayer) return {};
    const std::vector<uint32_t> header = read_words(pool, tile.atlas, PAGES_HEADER_WORDS);
    const std::vector<uint32_t> table = read_words(pool, tile.atlas, page_table_words(header));
    const std::vector<uint32_t> mesh = read_words(pool, tile.mesh, ~uint64_t{0});
    auto coordinates = make_chart_coordinates(wanted_, mesh, table);
    if (!coordinates) return {};
    Coordinates made{coordinates->transport, kNoLayer, std::move(coordinates->runs), 0};
    if (coordinates->words.empty()) return made;
    made.layer = create_layer(pool);
    const uint64_t slots = slots_to_append(pool, made.layer, coordinates->words.size());
    if (append_words(pool, made.layer, coordinates->words)) {
        slots_used_ += slots;
        return made;
    }
    destroy_layer(pool, made.layer);
    return {ChartTransport::kTable, kNoLayer, {}, slots};
}

const CoordinateLayers::Coordinates& CoordinateLayers::of(const TileDraw& tile, SlotPool& pool) {
    static const Coordinates kNone;
    if (wanted_ == ChartTransport::kTable) return kNone;
    const auto [at, is_new] = made_.try_emplace(std::pair(tile.mesh, tile.atlas));
    Coordinates& found = at->second;
    const bool has_room_now = found.refused_slots != 0 && found.refused_slots <= free_slots(pool);
    if (is_new || has_room_now) found = make(tile, pool);
    return found;
}

void CoordinateLayers::give_back(const Coordinates& coordinates, SlotPool& pool) {
    if (coordinates.layer == kNoLayer) return;
    slots_used_ -= pool.layers[coordinates.layer].slots.size();
    destroy_layer(pool, coordinates.layer);
}

void CoordinateLayers::forget(LayerId layer, SlotPool& pool) {
    std::erase_if(made_, [&](const auto& entry) {
        const auto& [key, coordinates] = entry;
        if (key.first != layer && key.second != layer) return false;
        give_back(coordinates, pool);
        return true;
    });
}

void CoordinateLayers::make_room(uint64_t slots, SlotPool& pool) {
    for (auto& [key, coordinates] : made_) {
        if (free_slots(pool) >= slots) return;
        if (coordinates.layer == kNoLayer) continue;
        const uint64_t held = pool.layers[coordinates.layer].slots.size();
        give_back(coordinates, pool);
        coordinates = {ChartTransport::kTable, kNoLayer, {}, held};
    }
}

}  // namespace citystream::client
