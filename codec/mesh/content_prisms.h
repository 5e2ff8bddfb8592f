// Takes the prisms out of the surface of a mesh layer. Only mesh_content_make.cpp needs it.
#pragma once

#include <cstdint>
#include <span>

#include "codec/mesh/mesh_content.h"

namespace citystream::codec::mesh {

/// Moves vertical walls of one colour under flat tops of one colour (prisms.h) from the triangles to the prisms. Of
/// the triangles only those that `may_be_prism` names, one flag a triangle, are looked at: undressed ones of one
/// colour whose normal is that of their plane. No floor has colour 0. All others and what does not fit keep their
/// order; points that no triangle has then are left out, the others are in order of first use. O(n log n).
void take_prisms(MeshContent& content, std::span<const uint8_t> may_be_prism);

}  // namespace citystream::codec::mesh
