#include "client/stream/draw_list.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "client/select/mip_clamp.h"
#include "client/stream/cover.h"

namespace citystream::client {

using tiles::tileset::Layer;

const std::vector<TileDraw>& DrawList::make(const Selection& selection, const SelectionView& view,
                                            StreamerFrame& frame) {
    draws_.clear();
    triangles_ = full_bits_ = shown_bits_ = 0;
    const CoverQuestions ask = {view.selected, view.refined, [&](NodeIndex node) { return selector_.visible(node); },
                                [&](NodeIndex node) { return residency_.drawable(node); }};
    const std::vector<NodeIndex> cover = cover_view(directory_, ask);
    covered_ = cover;
    std::sort(covered_.begin(), covered_.end());
    uint64_t as_chosen = 0;
    for (const NodeIndex node : cover) {
        const bool chosen = view.selected(node);
        if (chosen) ++as_chosen;
        if (residency_.has_mesh(node)) add(node, selection, chosen ? view.wanted(node) : nullptr, frame);
    }
    frame.tiles_drawn = draws_.size();
    frame.tiles_wanted = selection.tiles.size();
    frame.tiles_hidden = selection.hidden;
    frame.tiles_missing = selection.tiles.size() - as_chosen;
    frame.tolerance_used = selection.tolerance;
    if (triangles_ > 0) {
        frame.position_bits = static_cast<double>(shown_bits_) / static_cast<double>(triangles_);
        frame.full_position_bits = static_cast<double>(full_bits_) / static_cast<double>(triangles_);
    }
    return draws_;
}

const std::vector<TileDraw>& DrawList::make_casters(const CasterChoice& casters) {
    caster_draws_.clear();
    for (const SelectedTile& tile : casters.tiles) {
        if (is_covered(tile.node)) continue;
        auto draw = residency_.draw_mesh(tile.node, tile.steps_of(Layer::kMesh));
        if (!draw) continue;
        drop_positions(tile.node, casters.positions, &tile, *draw);
        caster_draws_.push_back(std::move(*draw));
    }
    return caster_draws_;
}

/// By itself or by an ancestor that stands in for what is on its way.
bool DrawList::is_covered(NodeIndex node) const {
    for (NodeIndex up = node; up != kNoNode; up = directory_.node(up).parent) {
        if (std::binary_search(covered_.begin(), covered_.end(), up)) return true;
    }
    return false;
}

/// Waiting mode draws exactly the chosen prefixes and levels, so that a frame depends on its camera alone; realtime
/// mode draws all steps that are resident. Of light, which wants the same prefix in every view that fits its budgets,
/// both show what is resident.
void DrawList::add(NodeIndex node, const Selection& selection, const SelectedTile* tile, StreamerFrame& frame) {
    const double pixels_per_metre = selector_.pixels_per_metre(node);
    const SelectedTile* shown = options_.wait_for_selection ? tile : nullptr;
    draws_.push_back(residency_.draw(node, shown));
    TileDraw& draw = draws_.back();
    if (const auto light = lights_.to_draw(node, shown)) light_by(node, *light, draw, frame);
    clamp_mips(node, selection.texel_tolerance, draw);
    drop_positions(node, selection.positions, tile, draw);
    count_bits(node, draw);
    std::vector<PlacementLevel> levels;
    if (tile == nullptr || tile->has_relief()) levels = selector_.placement_levels_of(node, selection.tolerance);
    const bool has_facades = !directory_.node(node).record->steps(Layer::kFacade).empty();
    const bool relief = !levels.empty() && residency_.add_relief(node, levels, draw);
    if (has_facades) ++(relief ? frame.relief_tiles : frame.flat_tiles);
    const double geometry =
        std::max(geometry_error_metres(node, draw) * pixels_per_metre, relief_error_pixels(levels, draw));
    const double position = position_error_pixels(node, selection, draw);
    frame.geometry_error_pixels = std::max(frame.geometry_error_pixels, geometry);
    frame.position_error_pixels = std::max(frame.position_error_pixels, position);
    frame.achieved_error_pixels = std::max(frame.achieved_error_pixels, geometry + position);
}

void DrawList::light_by(NodeIndex node, const LightResidency::Source& light, TileDraw& draw,
                        StreamerFrame& frame) const {
    const auto& manifest = directory_.manifest();
    const GridPoint own = manifest.tile_origin(*directory_.node(node).record);
    const GridPoint origin = manifest.tile_origin(*directory_.node(light.node).record);
    draw.radiance = light.layer;
    draw.radiance_offset = {static_cast<int32_t>(own.x - origin.x), static_cast<int32_t>(own.y - origin.y),
                            static_cast<int32_t>(own.z - origin.z)};
    ++(light.node == node ? frame.light_tiles : frame.light_inherited_tiles);
}

void DrawList::clamp_mips(NodeIndex node, double pixels, TileDraw& draw) const {
    if (!options_.continuous_mips || !(pixels > 1)) return;
    const auto& steps = directory_.node(node).record->steps(Layer::kAtlas);
    if (draw.atlas != kNoLayer) draw.atlas_least_mip = clamped_mip(steps, pixels / selector_.pixels_per_metre(node));
    const auto& uses = knowledge_.tiles[node].charts;
    for (size_t i = 0; i < draw.shared_charts.size(); ++i) {
        const double per_metre = selector_.chart_pixels_per_metre(node, uses[i].chart_in_tile);
        if (per_metre > 0)
            draw.shared_charts[i].least_mip = clamped_mip(double{uses[i].metres_per_texel}, pixels / per_metre);
    }
}

/// Nothing finer than chosen is shown, whatever is here: what a vertex shows depends on the camera alone.
void DrawList::drop_positions(NodeIndex node, const PositionRule& positions, const SelectedTile* tile,
                              TileDraw& draw) const {
    const auto dropped = dropped_bits(directory_.node(node).record->steps(Layer::kMesh));
    size_t shown = std::min<size_t>(draw.mesh_steps, dropped.size());
    if (tile != nullptr) shown = std::min<size_t>(shown, tile->steps_of(Layer::kMesh));
    draw.drop_rule = positions.drop;
    draw.mesh_least_dropped = shown > 0 ? dropped[shown - 1] : 0;
}

/// Bits of a coordinate within the tile's bounds, and those of them that are shown, of the triangles drawn so far.
void DrawList::count_bits(NodeIndex node, const TileDraw& draw) {
    const auto& bounds = directory_.node(node).record->bounds;
    double extent = 0;
    for (size_t c = 0; c < 3; ++c) extent = std::max(extent, bounds.max[c] - bounds.min[c]);
    const auto bits = static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(to_grid(extent))));
    uint64_t triangles = 0;
    for (const codec::mesh::MeshRange& range : draw.mesh_ranges) triangles += range.triangles;
    triangles_ += triangles;
    full_bits_ += triangles * bits;
    shown_bits_ += triangles * (bits - std::min(bits, draw.mesh_least_dropped));
}

/// Metres: of the tile itself, and of relief drawn flat.
double DrawList::geometry_error_metres(NodeIndex node, const TileDraw& draw) const {
    const auto& record = *directory_.node(node).record;
    double error = record.geometric_error;
    if (draw.facade == kNoLayer) error = std::max<double>(error, record.flat_facade_error);
    return error;
}

double DrawList::position_error_pixels(NodeIndex node, const Selection& selection, const TileDraw& draw) const {
    const double nearest = selector_.distance(node);
    const auto& bounds = directory_.node(node).record->bounds;
    const double across =
        std::hypot(bounds.max[0] - bounds.min[0], bounds.max[1] - bounds.min[1], bounds.max[2] - bounds.min[2]);
    return greatest_position_error(selection.positions, draw.mesh_least_dropped, nearest, nearest + across);
}

/// Of relief drawn with coarser maps, which leave out nothing that is larger than their texels.
double DrawList::relief_error_pixels(std::span<const PlacementLevel> levels, const TileDraw& draw) const {
    double error = 0;
    for (size_t i = 0; i < draw.map_of_placement.size(); ++i) {
        const FacadeMapBinding& map = draw.facade_maps[draw.map_of_placement[i]];
        const double metres = knowledge_.dictionary.texel_error(map_piece(map.map, map.level));
        error = std::max(error, metres * levels[i].pixels_per_metre);
    }
    return error;
}

}  // namespace citystream::client
