// Which level of its map each facade of a tile wants, by its own distance from the camera.
#pragma once

#include <span>
#include <vector>

#include "client/select/camera.h"
#include "client/select/facade_dictionary.h"
#include "codec/facade/facade_layer.h"
#include "codec/grid.h"

namespace citystream::client {

/// How fine the maps of a view must be.
struct ViewDemand {
    double texel_pixels = 0;        ///< what projects to less may be missing
    std::optional<uint32_t> level;  ///< this level instead, or the finest where a map has fewer
};

/// Stands for a facade of whose map nothing can be had.
inline constexpr MapPiece kNoPiece = ~MapPiece{0};

struct PlacementLevel {
    MapPiece piece = kNoPiece;
    double pixels_per_metre = 0;  ///< at the wall's nearest point
};

/// Metres from the camera to the nearest point of the wall, a rectangle; not less than the near plane. `origin`: of the
/// tile.
double distance_to_wall(const Camera& camera, const GridPoint& origin, const codec::facade::Placement& wall);

/// The rule for levels: of each placement the coarsest level whose texels project below the demand
/// (FacadeDictionary::wanted). In their order; O(placements).
std::vector<PlacementLevel> placement_levels(const FacadeDictionary& dictionary, const Camera& camera,
                                             const GridPoint& origin,
                                             std::span<const codec::facade::Placement> placements,
                                             const ViewDemand& demand);

/// The levels that some placement wants: sorted, distinct.
std::vector<MapPiece> distinct_pieces(std::span<const PlacementLevel> levels);

}  // namespace citystream::client
