// Skirts: strips that hang down from the ground's edges along a tile's border, so that neighbours of another level show
// no gap.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// A vertical quad, counter-clockwise from outside the tile, lit and textured like the edge of the ground it hangs
/// from.
struct SkirtQuad {
    std::array<GridPoint, 4> corners;
    std::array<std::array<int64_t, 2>, 4> texcoords;
    std::array<float, 3> normal{};
    uint32_t object = 0, paint = 0;  ///< index in the span given; paint of that object
};

/// One quad for every edge of a ground triangle that lies on the border of the square (corner, side) and that no second
/// triangle shares.
std::vector<SkirtQuad> make_skirts(std::span<const quadtree::BuildObject> objects, const GridPoint& corner,
                                   int64_t side, int64_t depth);

/// Unit normal of a triangle; up for a degenerate one.
std::array<float, 3> unit_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c);

}  // namespace citystream::tiles::layers
