// The triangles of a mesh as what a lossless codec has to keep of them.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

/// All triangles by their places, each turned to its least form, sorted: equal for equal meshes. Empty when a corner is
/// no point of the mesh.
inline std::vector<std::array<GridPoint, 3>> triangles_by_place(const GridMesh& mesh) {
    std::vector<std::array<GridPoint, 3>> triangles;
    for (const auto& t : mesh.triangles) {
        if (std::max({t[0], t[1], t[2]}) >= mesh.points.size()) return {};
        std::array<GridPoint, 3> corners = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
        // The smallest of the three turns: corners may be equal.
        auto least = corners;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            least = std::min(least, corners);
        }
        triangles.push_back(least);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

}  // namespace citystream::codec::mesh
