#include "client/stream/draw_list.h"

#include <algorithm>

#include "client/select/mip_clamp.h"
#include "client/stream/cover.h"

namespace citystream::client {

using tiles::tileset::Layer;

const std::vector<TileDraw>& DrawList::make(const Selection& selection, const SelectionView& view,
                                            StreamerFrame& frame) {
    draws_.clear();
    const CoverQuestions ask = {view.selected, view.refined, [&](NodeIndex node) { return selector_.visible(node); },
                                [&](NodeIndex node) { return residency_.drawable(node); }};
    const std::vector<NodeIndex> cover = cover_view(directory_, ask);
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
    return draws_;
}

/// Waiting mode draws exactly the chosen prefixes and levels, so that a frame depends on its camera alone; realtime
/// mode draws all steps that are resident.
void DrawList::add(NodeIndex node, const Selection& selection, const SelectedTile* tile, StreamerFrame& frame) {
    const double pixels_per_metre = selector_.pixels_per_metre(node);
    draws_.push_back(residency_.draw(node, options_.wait_for_selection ? tile : nullptr));
    TileDraw& draw = draws_.back();
    clamp_mips(node, selection.texel_tolerance, draw);
    std::vector<PlacementLevel> levels;
    if (tile == nullptr || tile->has_relief()) levels = selector_.placement_levels_of(node, selection.tolerance);
    const bool has_facades = !directory_.node(node).record->steps(Layer::kFacade).empty();
    const bool relief = !levels.empty() && residency_.add_relief(node, levels, draw);
    if (has_facades) ++(relief ? frame.relief_tiles : frame.flat_tiles);
    const double error = std::max(error_metres(node, draw) * pixels_per_metre, relief_error_pixels(levels, draw));
    frame.achieved_error_pixels = std::max(frame.achieved_error_pixels, error);
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

/// Metres: of the tile itself, of steps that were left away, and of relief drawn flat.
double DrawList::error_metres(NodeIndex node, const TileDraw& draw) const {
    const auto& record = *directory_.node(node).record;
    double error = record.geometric_error;
    const auto& mesh = record.steps(Layer::kMesh);
    const size_t drawn = draw.mesh_step_words.size();
    if (drawn > 0 && drawn < mesh.size()) error = std::max<double>(error, mesh[drawn - 1].error);
    if (draw.facade == kNoLayer) error = std::max<double>(error, record.flat_facade_error);
    return error;
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
