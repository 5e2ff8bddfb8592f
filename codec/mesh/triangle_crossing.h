// Whether two triangles on the grid meet, exactly.
#pragma once

#include <array>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

using GridTriangle = std::array<GridPoint, 3>;

bool has_area(const GridTriangle& triangle);

/// Whether the closed triangles have a point in common; triangles without area meet nothing. Exact for all grid points
/// (128-bit determinants).
bool triangles_meet(const GridTriangle& a, const GridTriangle& b);

}  // namespace citystream::codec::mesh
