#include "client/stream/occlusion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace citystream::client {
namespace {

/// Metres: tiles up to here are chosen first, then up to twice that, ...: those that the nearer ones hide never are.
constexpr double kFirstHorizon = 32;
/// Samples by which surfaces are taken smaller at most.
constexpr double kMostMargin = 8;

}  // namespace

void Occlusion::begin(const Camera& camera, double tolerance_pixels) {
    const double margin = 1 + std::ceil(tolerance_pixels);
    if (margin > kMostMargin) {
        look_everywhere();
        return;
    }
    picture_.begin(camera, static_cast<uint32_t>(margin));
    drawn_.assign(directory_.nodes().size(), 0);
    horizon_ = kFirstHorizon;
    selector_.look_past(&picture_, horizon_);
}

void Occlusion::look_everywhere() {
    horizon_ = std::numeric_limits<double>::infinity();
    selector_.look_past(nullptr, horizon_);
}

bool Occlusion::look_farther(const Selection& selection) {
    if (!std::isfinite(selection.nearest_beyond)) return false;
    drawn_.resize(directory_.nodes().size(), 0);
    bool drawn = false;
    for (const SelectedTile& tile : selection.tiles) {
        if (std::exchange(drawn_[tile.node], uint8_t{1}) != 0) continue;
        draw(tile, selection.tolerance);
        drawn = true;
    }
    if (drawn) picture_.finish();
    horizon_ = std::max(2 * horizon_, selection.nearest_beyond);
    selector_.look_past(&picture_, horizon_);
    return true;
}

/// As the frame will show the tile.
void Occlusion::draw(const SelectedTile& tile, double tolerance) {
    if (!residency_.drawable(tile.node) || !residency_.has_mesh(tile.node)) return;
    TileDraw relief;
    bool has_relief = false;
    if (tile.has_relief()) {
        const auto levels = selector_.placement_levels_of(tile.node, tolerance);
        has_relief = !levels.empty() && residency_.add_relief(tile.node, levels, relief);
    }
    const CachedLayer& mesh = cache_.at(layer_key(tile.node, tiles::tileset::Layer::kMesh));
    const uint32_t steps = std::min<uint32_t>(tile.steps_of(tiles::tileset::Layer::kMesh), mesh.store_steps);
    occluders_.draw(tile.node, steps, !has_relief, picture_);
    if (has_relief) draw_relief(tile.node, relief);
}

void Occlusion::draw_relief(NodeIndex node, const TileDraw& draw) {
    const GridPoint origin = directory_.manifest().tile_origin(*directory_.node(node).record);
    const auto& placements = knowledge_.tiles[node].placements;
    const FacadeDictionary& dictionary = knowledge_.dictionary;
    for (size_t i = 0; i < placements.size(); ++i) {
        const FacadeMapBinding& map = draw.facade_maps[draw.map_of_placement[i]];
        const MapPiece piece = map_piece(map.map, map.level);
        if (!dictionary.opaque(piece)) continue;
        const double lowest = dictionary.record(map.map).depth_min_mm * 0.001 -
                              static_cast<double>(dictionary.record_of(piece).displacement_error);
        draw_back_of(placements[i], origin, std::max(0.0, -lowest), picture_);
    }
}

}  // namespace citystream::client
