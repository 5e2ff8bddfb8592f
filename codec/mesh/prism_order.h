// The order in which prisms are told: each hangs on one told before, at the two points where they are close.
//
// A tree over all prisms of about the least total distance between joined points (a minimum spanning tree found level
// by level on grids of growing cells), walked depth first. A close pair of points makes a small difference; which ones
// is the cheaper to say the fewer points the parent has, and for the child it costs nothing, as its ring may begin
// anywhere.
//
// Deterministic; about O(n log n) for n points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

struct PrismVisit {
    uint32_t prism = 0;              ///< place in the given prisms
    uint32_t start = 0;              ///< point of its outer ring that is told first
    uint32_t parent_point = 0;       ///< point of the parent's outer ring, counted from the parent's own start
    std::vector<uint32_t> children;  ///< visits, in order
};

/// Visits in the order in which they are told: each before its children, the first one is the root of all.
std::vector<PrismVisit> order_prisms(std::span<const Prism> prisms);

}  // namespace citystream::codec::mesh
