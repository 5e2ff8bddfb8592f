// Normals of a mesh's corners, coded on their own: points are welded by position alone, and what differs from corner to
// corner - hard edges, flat faces - does not cut them apart. Lossless on octahedral codes (octahedral.h).
//
// Most normals follow from the positions and from their neighbours:
//   - a triangle with one normal is flat; mostly that is the one of its plane, which costs the two decisions that say
//     so, some thousandths of a bit where all are; else one met there or on a wall shortly before (flat_normal_code.h);
//   - a corner of another triangle is predicted as modelling tools make normals: from the triangles round its point
//     whose planes turn from its own by no more than a crease angle, weighted by their angles there, by Max's weights
//     (1999: exact on spheres), by area or not. The encoder finds crease and weights for the mesh;
//   - what is left is mostly the normal met before at that point (of a flat triangle at one of its three) which is
//     nearest to the prediction: one decision. Else the difference (octahedral_residual.h) is coded.
// Positions are those that the decoder has, too: equal positions, equal triangles in equal order. Both sides reckon
// predictions in doubles with exact operations and roots only, in a fixed order. O(corners); encoding takes one pass
// over all and fourteen over at most 30,000 corners.
//
// Untrusted bytes: any bytes decode to canonical codes or an error; memory depends on the mesh alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

constexpr uint32_t kMostCornerNormalBits = 24;  ///< a parameter

/// Codes 3 codes a triangle, any codes of `bits` 2..kMostCornerNormalBits.
void encode_corner_normals(bits::RangeEncoder& encoder, const GridMesh& mesh, std::span<const uint64_t> codes,
                           uint32_t normal_bits);
/// Canonical codes (canonical_octahedral) of the same directions. Where the bytes run out the rest are some codes:
/// check the decoder.
std::vector<uint64_t> decode_corner_normals(bits::RangeDecoder& decoder, const GridMesh& mesh, uint32_t normal_bits);

/// The same as bytes of their own.
std::vector<std::byte> encode_corner_normals(const GridMesh& mesh, std::span<const uint64_t> codes,
                                             uint32_t normal_bits);
Result<std::vector<uint64_t>> decode_corner_normals(const GridMesh& mesh, uint32_t normal_bits,
                                                    std::span<const std::byte> bytes);

}  // namespace citystream::codec::mesh
