#include "client/load/drawn_prefixes.h"

#include <algorithm>

#include "client/select/selection.h"

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

void DrawnPrefixes::credit_charts(const TileDraw& draw, Shown& shown) {
    shown.charts.clear();
    for (const SharedChartBinding& binding : draw.shared_charts) {
        shown.charts.push_back({binding.chart, binding.levels});
        const uint64_t wire = index_.chart_bytes(shown.charts.back());
        uint64_t& before = chart_bytes_[binding.chart];
        if (wire <= before) continue;
        bytes_ += wire - before;
        before = wire;
    }
}

void DrawnPrefixes::credit_draw(const TileDraw& draw, Shown& shown) {
    shown.mesh_steps = draw.mesh_steps;
    credit(*shown.record, Layer::kMesh, decoded_prefix_bytes(shown.record->steps(Layer::kMesh), draw.mesh_steps));
    if (draw.atlas != kNoLayer) {
        shown.atlas_bytes = store_.bytes_of(draw.atlas);
        credit(*shown.record, Layer::kAtlas, shown.atlas_bytes);
    }
    credit_charts(draw, shown);
    shown.light_bytes = light_bytes(draw);
    credit(*shown.record, Layer::kRadiance, shown.light_bytes);
    if (draw.facade == kNoLayer) return;
    shown.facade = draw.facade;
    credit(*shown.record, Layer::kFacade, store_.bytes_of(draw.facade));
    shown.maps.clear();
    for (const FacadeMapBinding& binding : draw.facade_maps) {
        shown.maps.push_back(binding.layer);
        const MapPiece piece = map_piece(binding.map, binding.level);
        if (pieces_.insert(piece).second) bytes_ += index_.map_bytes(piece);
    }
}

bool DrawnPrefixes::has_grown(const TileDraw& draw, const Shown& shown) const {
    const bool same_atlas = draw.atlas == kNoLayer || shown.atlas_bytes == store_.bytes_of(draw.atlas);
    if (shown.mesh_steps != draw.mesh_steps || shown.facade != draw.facade || !same_atlas) return true;
    if (shown.light_bytes != light_bytes(draw)) return true;
    const bool same_charts =
        std::equal(draw.shared_charts.begin(), draw.shared_charts.end(), shown.charts.begin(), shown.charts.end(),
                   [](const SharedChartBinding& binding, const ChartPrefix& was) {
                       return binding.chart == was.chart && binding.levels == was.levels;
                   });
    if (!same_charts) return true;
    return draw.facade != kNoLayer &&
           !std::equal(draw.facade_maps.begin(), draw.facade_maps.end(), shown.maps.begin(), shown.maps.end(),
                       [](const FacadeMapBinding& binding, LayerId layer) { return binding.layer == layer; });
}

void DrawnPrefixes::note(const std::vector<TileDraw>& draws,
                         const std::function<void(tiles::tileset::TileAddress, bool)>& on_tile) {
    for (const TileDraw& draw : draws) {
        if (draw.mesh == kNoLayer) continue;
        const auto [place, appeared] = shown_.try_emplace(draw.mesh);
        Shown& shown = place->second;
        if (shown.record == nullptr) shown.record = index_.find(draw);
        if (shown.record == nullptr) continue;
        if (has_grown(draw, shown)) credit_draw(draw, shown);
        on_tile(shown.record->address, appeared);
    }
}

}  // namespace citystream::client
