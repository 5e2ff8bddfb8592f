#include "client/load/drawn_prefixes.h"

namespace citystream::client {

using tiles::tileset::Layer;
using tiles::tileset::TileRecord;

void DrawnPrefixes::credit(const TileRecord& record, Layer layer, uint64_t decoded_bytes) {
    uint64_t wire = 0, decoded = 0;
    for (const auto& step : record.steps(layer)) {
        decoded += step.decoded_bytes;
        if (decoded > decoded_bytes) break;
        wire = step.end;
    }
    uint64_t& before = credited_[record.address][static_cast<size_t>(layer)];
    if (wire <= before) return;
    bytes_ += wire - before;
    before = wire;
}

void DrawnPrefixes::credit_draw(const TileDraw& draw, Shown& shown) {
    shown.mesh_steps = draw.mesh_step_words.size();
    uint64_t mesh_words = 0;
    for (const uint32_t words : draw.mesh_step_words) mesh_words += words;
    credit(*shown.record, Layer::kMesh, mesh_words * 4);
    if (draw.atlas != kNoLayer) {
        shown.atlas_bytes = store_.bytes_of(draw.atlas);
        credit(*shown.record, Layer::kAtlas, shown.atlas_bytes);
    }
    if (draw.facade == kNoLayer) return;
    shown.facade = draw.facade;
    credit(*shown.record, Layer::kFacade, store_.bytes_of(draw.facade));
    for (const FacadeMapBinding& binding : draw.facade_maps) {
        if (maps_.insert(binding.map).second) bytes_ += index_.map_bytes(binding.map);
    }
}

void DrawnPrefixes::note(const std::vector<TileDraw>& draws,
                         const std::function<void(tiles::tileset::TileAddress, bool)>& on_tile) {
    for (const TileDraw& draw : draws) {
        if (draw.mesh == kNoLayer) continue;
        const auto [place, appeared] = shown_.try_emplace(draw.mesh);
        Shown& shown = place->second;
        if (shown.record == nullptr) shown.record = index_.find(draw);
        if (shown.record == nullptr) continue;
        const bool grown = shown.mesh_steps != draw.mesh_step_words.size() || shown.facade != draw.facade ||
                           (draw.atlas != kNoLayer && shown.atlas_bytes != store_.bytes_of(draw.atlas));
        if (grown) credit_draw(draw, shown);
        on_tile(shown.record->address, appeared);
    }
}

}  // namespace citystream::client
