// Normals of a triangle's corners as codes that cost next to nothing where they follow from its plane.
//
// A triangle whose three normals have one code is flat, and a reader of the wire expects its normal from the positions
// that it knows. So where the code of the plane - at the coarsest step, else at the finest - is as right as the one
// given, within the greatest error of a code, it stands for it.
#pragma once

#include <array>
#include <cstdint>

#include "codec/mesh/direction.h"
#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

struct TriangleNormals {
    std::array<uint32_t, 3> codes{};  ///< canonical octahedral codes
    bool of_plane = false;  ///< all of them are the normal of the triangle's plane, within the error of a code
};

/// `given`: of any length. `coarsest`, `finest`: low bits that the first and the last step drop.
TriangleNormals triangle_normals(const std::array<GridPoint, 3>& corners, const std::array<Direction, 3>& given,
                                 uint32_t normal_bits, uint32_t coarsest, uint32_t finest);

}  // namespace citystream::codec::mesh
