// What is drawn of a selection: the tiles that cover the view with what is resident, each with the mips, maps and steps
// that it may show, and the error that is seen.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "client/cache/directory_cache.h"
#include "client/select/caster_selection.h"
#include "client/select/selection.h"
#include "client/stream/city_streamer.h"
#include "client/stream/light_residency.h"
#include "client/stream/tile_residency.h"

namespace citystream::client {

/// What the list asks about the current selection.
struct SelectionView {
    std::function<bool(NodeIndex)> selected, refined;
    std::function<const SelectedTile*(NodeIndex)> wanted;  ///< nothing: neither selected nor a stand-in
};

class DrawList {
  public:
    /// All must outlive it.
    DrawList(const DirectoryCache& directory, const CityKnowledge& knowledge, TileResidency& residency,
             LightResidency& lights, Selector& selector, const StreamerOptions& options)
        : directory_(directory),
          knowledge_(knowledge),
          residency_(residency),
          lights_(lights),
          selector_(selector),
          options_(options) {}

    /// Draws of the view that was chosen last; fills the frame's counts of tiles and errors. Valid until the next call.
    const std::vector<TileDraw>& make(const Selection& selection, const SelectionView& view, StreamerFrame& frame);
    /// Those of the casters whose meshes are here and that nothing of the last make() covers. Valid until the next
    /// call.
    const std::vector<TileDraw>& make_casters(const CasterChoice& casters);

  private:
    void add(NodeIndex node, const Selection& selection, const SelectedTile* tile, StreamerFrame& frame);
    void light_by(NodeIndex node, const LightResidency::Source& light, TileDraw& draw, StreamerFrame& frame) const;
    void clamp_mips(NodeIndex node, double pixels, TileDraw& draw) const;
    void drop_positions(NodeIndex node, const PositionRule& positions, const SelectedTile* tile, TileDraw& draw) const;
    bool is_covered(NodeIndex node) const;
    void count_bits(NodeIndex node, const TileDraw& draw);
    double geometry_error_metres(NodeIndex node, const TileDraw& draw) const;
    double position_error_pixels(NodeIndex node, const Selection& selection, const TileDraw& draw) const;
    double relief_error_pixels(std::span<const PlacementLevel> levels, const TileDraw& draw) const;

    const DirectoryCache& directory_;
    const CityKnowledge& knowledge_;
    TileResidency& residency_;
    LightResidency& lights_;
    Selector& selector_;
    const StreamerOptions& options_;
    std::vector<TileDraw> draws_, caster_draws_;
    std::vector<NodeIndex> covered_;                           ///< by draws_: ascending
    uint64_t triangles_ = 0, full_bits_ = 0, shown_bits_ = 0;  ///< of draws_
};

}  // namespace citystream::client
