// Walls between neighbours: facades that nobody sees, because facades of other buildings stand against them.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// How far two walls that face each other may be apart (or, the other way, inside one another) and still be one wall to
/// whoever looks: metres.
inline constexpr double kPartyGap = 0.3, kPartyOverlap = 0.05;

/// Makes plain walls in their mean colour of the facades that facades of other objects in the list hide from end to end
/// and from foot to top; one that stands out over a lower neighbour stays. Returns how many. The order of the list does
/// not matter. O(n) for facades that are spread out.
uint64_t hide_party_walls(std::vector<quadtree::BuildObject>& objects, FacadePainter& facades);

}  // namespace citystream::tiles::layers
