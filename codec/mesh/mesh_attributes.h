// What triangles and their corners have besides places: normals, the dressed flag, chart words, texture coordinates.
//
// Triangles come in the order of a walk over their surface (surface_walk.h), each mostly beside one that is known. The
// normals of all come first (corner_normals.h); then, triangle by triangle, the flag, the word and the coordinates,
// each expected from the triangles beyond its edges, from whether these lie in the same plane, and from where its
// plane faces. Nothing here needs more than the positions that a reader of the first step has.
//
// One template for writer and reader (range_coder.h). O(1) a triangle but for a look-up of its chart.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/mesh_content.h"

namespace citystream::codec::mesh {

/// What the parts of attributes cost, in bits.
struct AttributeBits {
    double normals = 0, dressed = 0, charts = 0, texcoords = 0;
};

/// `triangles` have the corners of mesh.triangles, in their order. normal_bits as MeshContent says; texture coordinates
/// of triangles of one colour are not written.
AttributeBits encode_attributes(bits::RangeEncoder& encoder, const GridMesh& mesh, uint32_t normal_bits,
                                std::span<const MeshTriangle> triangles);

/// The same triangles; normals are canonical codes. Any bytes give some: check the decoder.
std::vector<MeshTriangle> decode_attributes(bits::RangeDecoder& decoder, const GridMesh& mesh, uint32_t normal_bits);

}  // namespace citystream::codec::mesh
