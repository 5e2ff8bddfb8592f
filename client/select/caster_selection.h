// Which tiles out of view cast shadows into it, and how much of their meshes: the one rule, at the place where their
// shadows may fall nearest.
#pragma once

#include <functional>
#include <vector>

#include "client/select/caster_volume.h"
#include "client/select/selection.h"

namespace citystream::client {

/// A shadow's rim may be off by so many times what a surface may be: shadow maps have texels of their own, and sun
/// discs half shades.
inline constexpr double kCasterTolerance = 4;

struct CasterQuestion {
    Camera camera;
    CasterLimits limits;
    double tolerance = 0;           ///< pixels: as Selection
    double position_tolerance = 0;  ///< pixels: as Selection
    /// In the picture, and an ancestor of such tiles.
    std::function<bool(NodeIndex)> drawn, refined;
};

struct CasterChoice {
    std::vector<SelectedTile> tiles;                    ///< nothing but steps of meshes, greatest shadows first
    PositionRule positions;                             ///< that the steps follow from
    std::vector<tiles::tileset::TileAddress> subtrees;  ///< not loaded yet, but needed to refine
    bool left_out = false;                              ///< of some the budget does not hold the meshes
};

/// Tiles that cover all that may cast shadows into the view and is not drawn; none is an ancestor of another or of a
/// drawn one. What they take is added to `cost`, as long as it fits the budget. O(tiles in the volume and their
/// ancestors).
CasterChoice choose_casters(const DirectoryCache& directory, const CityKnowledge& knowledge,
                            const CasterQuestion& question, const SelectionBudget& budget, SelectionCost& cost);

}  // namespace citystream::client
