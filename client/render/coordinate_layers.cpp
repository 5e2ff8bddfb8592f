#include "client/render/coordinate_layers.h"

#include "codec/atlas/page_layout.h"

namespace citystream::client {

void CoordinateLayers::destroy() {
    destroy_slot_pool(pool_);
    made_.clear();
}

CoordinateLayers::Coordinates CoordinateLayers::make(const TileDraw& tile, const SlotPool& layers) {
    if (tile.mesh == kNoLayer || tile.mesh_step_words.empty()) return {};
    const std::vector<uint32_t> header = read_words(layers, tile.atlas, PAGES_HEADER_WORDS);
    const std::vector<uint32_t> table = read_words(layers, tile.atlas, page_table_words(header));
    const std::vector<uint32_t> mesh = read_words(layers, tile.mesh, tile.mesh_step_words[0]);
    auto coordinates = make_chart_coordinates(wanted_, mesh, table);
    if (!coordinates) return {};
    Coordinates made{coordinates->transport, kNoLayer, std::move(coordinates->runs)};
    if (coordinates->words.empty()) return made;
    made.layer = create_layer(pool_);
    if (append_words(pool_, made.layer, coordinates->words)) return made;
    destroy_layer(pool_, made.layer);
    return {};
}

const CoordinateLayers::Coordinates& CoordinateLayers::of(const TileDraw& tile, const SlotPool& layers) {
    static const Coordinates kNone;
    if (wanted_ == ChartTransport::kTable) return kNone;
    const std::pair key(tile.mesh, tile.atlas);
    auto found = made_.find(key);
    if (found == made_.end()) found = made_.emplace(key, make(tile, layers)).first;
    return found->second;
}

void CoordinateLayers::forget(LayerId layer) {
    std::erase_if(made_, [&](const auto& entry) {
        const auto& [key, coordinates] = entry;
        if (key.first != layer && key.second != layer) return false;
        if (coordinates.layer != kNoLayer) destroy_layer(pool_, coordinates.layer);
        return true;
    });
}

}  // namespace citystream::client
