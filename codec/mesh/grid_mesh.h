// A triangle mesh on the integer grid: what the geometry codecs take and give.
//
// Points may be shared by position or not: each codec says what it needs. A mesh is the same as another when both have
// the same multiset of triangles, each by its points in order up to a turn (never a reflection); the order of triangles
// and of points, and points that no triangle uses, mean nothing.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace citystream::codec::mesh {

using GridPoint = std::array<int32_t, 3>;  ///< grid units, each below 2^30 in magnitude

struct GridMesh {
    std::vector<GridPoint> points;
    std::vector<std::array<uint32_t, 3>> triangles;  ///< each index below points.size()
};

}  // namespace citystream::codec::mesh
