// A facade without its relief: the rectangles of wall that stand in for it where it is too far away, or has not come
// yet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/facade/run_grid.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Part of a facade map, in 2^-16 of its width and height.
struct FacadePanel {
    std::array<uint32_t, 2> lo{}, hi{};
    friend bool operator==(const FacadePanel&, const FacadePanel&) = default;
};

struct FacadePanels {
    std::vector<FacadePanel> panels;
    double error_metres = 0;  ///< how far their outline is from that of the map's surface, in metres of the map
};

/// One panel for a map without open cells; else few that together cover its surface, on texels of 8 cm or as coarse as
/// it takes. None where hardly any surface is left. `texel_metres`: of the map.
FacadePanels flat_panels(const codec::facade::RunGrid& map, double texel_metres);

/// A panel on a wall: corners counter-clockwise from outside, from the lower left one; texture coordinates in 2^-16 of
/// the facade's picture. Panels that share a corner of the map share its point.
struct FlatQuad {
    std::array<GridPoint, 4> corners;
    std::array<std::array<int64_t, 2>, 4> texcoords;
};
FlatQuad flat_quad(const quadtree::BuildFacade& facade, const FacadePanel& panel);

/// Two triangles for each panel of a facade, in its place, to the triangles of an object.
void add_flat_wall(quadtree::BuildObject& object, const quadtree::BuildFacade& facade, const FacadePanels& flat,
                   const quadtree::Paint& paint);

}  // namespace citystream::tiles::layers
