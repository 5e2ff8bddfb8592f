// Mesh layers by libdraco instead of mesh_wire.h: for comparison, and for whoever has nothing else. One step, lossless
// on the grid of the last step. Prisms travel as triangles and are found again by the reader, so that what is kept and
// drawn is the same.
//
// The bytes: "CSDM"; bytes: bits dropped, bits a parameter of a normal, topology; the charts: their number and each
// one's word, of an image also its texture coordinates' bases (zigzag) and shifts; then two meshes: number of triangles
// and of bytes, and Draco's bytes. Numbers are in bytes of 7 bits, low ones first. The first mesh is coded by
// Draco's edgebreaker, the second, of triangles with two corners at one place, which that leaves out, one triangle
// after the other; so is the first if anything of it did not come back. Corners have four attributes of 32-bit
// integers: place (>> dropped), texture coordinate (from the chart's base, >> its shift), normal (both parameters),
// face (2 * chart, + 1 if dressed).
#pragma once

#include <cstddef>
#include <span>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_wire.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// Whether a first step is one of these: those of mesh_wire.h begin otherwise.
bool is_draco_mesh(std::span<const std::byte> bytes);

/// Bits of the span of places on an axis without those dropped: 4 km of all bits. libdraco counts how often each
/// difference occurs in a table of as many entries as there are differences.
inline constexpr uint32_t kMostDracoPlaceBits = 22;

/// One step and the content as its reader will have it: one step, no most_dropped, prisms as they are found among all
/// triangles of one colour that have the code of their plane. Preconditions: those of
/// encode_mesh_wire, and texture coordinates of a chart span at most 16 bits less common trailing zeros, as
/// make_content has them. Error: places of more than kMostDracoPlaceBits, or libdraco declines (no such mesh is known):
/// such a layer travels by mesh_wire.h. Deterministic for one version of libdraco.
Result<MeshWire> encode_draco_mesh(const MeshContent& content);

/// For untrusted bytes: an error or sound content. A mesh of n triangles has at least n / kDracoTrianglesPerByte bytes
/// (the encoder fills up), so that memory is in proportion to the bytes, and within the limits.
Result<MeshContent> decode_draco_mesh(std::span<const std::byte> bytes, const MeshLimits& limits = {});
inline constexpr uint32_t kDracoTrianglesPerByte = 16;

}  // namespace citystream::codec::mesh
