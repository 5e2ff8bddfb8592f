// Constrained precision of a mesh layer. Only mesh_content_make.cpp needs it.
#pragma once

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_content_make.h"

namespace citystream::codec::mesh {

/// Sets most_dropped by the constraint, at least what the last step drops; leaves it empty where no point asks for
/// more than each step has. Prisms ask for nothing: call it while all triangles are in the surface. O(n log n).
void constrain(MeshContent& content, const MeshConstraint& constraint);

}  // namespace citystream::codec::mesh
