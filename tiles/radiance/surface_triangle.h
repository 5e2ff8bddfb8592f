// The surface of a city as what light falls on and what stands in its way: triangles on the global grid, without
// materials.
#pragma once

#include <array>
#include <cstdint>

#include "codec/grid.h"

namespace citystream::tiles::radiance {

/// Corners counter-clockwise seen from outside, absolute. Triangles without area are allowed: they hide nothing.
struct SurfaceTriangle {
    std::array<GridPoint, 3> corners;
    friend bool operator==(const SurfaceTriangle&, const SurfaceTriangle&) = default;
};

/// Twice the area along the normal, grid units squared: exact for triangles of less than 2^30 grid units (1,000 km) in
/// each direction.
inline std::array<int64_t, 3> exact_normal(const SurfaceTriangle& triangle) {
    const auto& [p, q, r] = triangle.corners;
    const std::array<int64_t, 3> u = {q.x - p.x, q.y - p.y, q.z - p.z}, v = {r.x - p.x, r.y - p.y, r.z - p.z};
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

}  // namespace citystream::tiles::radiance
