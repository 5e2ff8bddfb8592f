// How a polygon with holes is most likely cut into triangles: a guess from its rings alone.
//
// Most tessellators sweep a line over the polygon, cut it into pieces that the line meets in one stretch (de Berg et
// al., Computational Geometry, 3.2), and these into triangles from the other end with a stack (3.3); so does the one of
// OpenGL's utility library, which our readers use. Convex quadrilaterals are cut along the shorter diagonal.
//
// Whatever the rings, the result is some triangles over their points and the same on every machine; it is only of use
// as a guess. O(n log n + n s) for n points of which s edges lie on the line at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

/// Triangles over the points counted through the rings, counter-clockwise.
std::vector<std::array<uint32_t, 3>> sweep_triangles(std::span<const Ring> rings);

}  // namespace citystream::codec::mesh
