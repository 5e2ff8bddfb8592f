// The plane that a triangle on the grid lies in.
#pragma once

#include <array>

#include "codec/mesh/direction.h"
#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

/// Perpendicular, towards whoever sees the corners counter-clockwise, as long as twice the area; {0, 0, 0} where that
/// is none. Coordinates below 2^26 give exact products; beyond, doubles round.
inline Direction plane_vector(const std::array<GridPoint, 3>& corners) {
    std::array<Direction, 2> edge{};
    for (size_t c = 0; c < 3; ++c) {
        for (size_t e = 0; e < 2; ++e)
            edge[e][c] = static_cast<double>(corners[e + 1][c]) - static_cast<double>(corners[0][c]);
    }
    const auto& [a, b] = edge;
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Unit length; +z where the triangle has no area.
inline Direction plane_normal(const std::array<GridPoint, 3>& corners) {
    return unit_direction(plane_vector(corners));
}

}  // namespace citystream::codec::mesh
