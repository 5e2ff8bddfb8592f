// A tile's mesh layer on the wire: one string of bytes a step. Step 0 has everything but the low bits of positions,
// step s the bits between dropped[s - 1] and dropped[s]. MESH_WIRE.md has the bytes.
//
// All of a step is one range coded stream: prisms (prism_code.h) and their colours, a walk over all other triangles
// (surface_walk.h), how many bits each point may drop, then what triangles and corners have besides places
// (mesh_attributes.h), each expected from the triangle that the walk comes from.
//
// Time: 2 to 3 us a triangle to decode, less for prisms, two to three times that to encode; some microseconds for a
// single triangle. Memory: some hundred bytes a triangle, and models of the contexts that were met: 3 MB at most. Bytes
// depend on the content alone.
//
// Untrusted bytes: every index, coordinate and count is checked; reading stops at the end of the bytes or at the
// limits, and nothing is allocated by a number that was read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/mesh_attributes.h"
#include "codec/mesh/mesh_content.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct KnownLattices;

/// What a reader is ready to make room for.
struct MeshLimits {
    uint32_t points = 1u << 24, triangles = 1u << 25;  ///< those of prisms count, too
};

/// What the parts of a layer take, in bits.
struct MeshWireBits {
    double header = 0, prisms = 0, prism_colours = 0;
    double topology = 0, positions = 0;  ///< of the walk, in step 0
    double most_dropped = 0;
    AttributeBits attributes;
    double refinement = 0;  ///< all further steps
};

/// A layer as it travels, and what its reader will have of all steps: the same triangles, in the order of the wire.
struct MeshWire {
    std::vector<std::vector<std::byte>> steps;  ///< content.dropped.size(), none of them empty
    MeshContent content;
    MeshWireBits bits;
};

/// Lossless down to the bits that the last step drops, but for what means nothing: the order of prisms, points and
/// triangles and where rings and triangles begin, points that no triangle uses, the texture coordinates of triangles of
/// one colour (0), the floor's colour where there is no floor (0), and which of several codes a normal has. Points at
/// one place become one; of theirs the least most_dropped counts. Deterministic. Precondition: coordinates below 2^30
/// in magnitude, indices in range, and the rest as MeshContent says.
///
/// `known`: what the last call found that this one may need again (lattice_code.h); bytes do not depend on it.
MeshWire encode_mesh_wire(const MeshContent& content, KnownLattices* known = nullptr);

/// The content of the first steps.size() >= 1 steps. Its `dropped` has all steps that step 0 announces; order, counts
/// and all that is not a position are the same whatever the number of steps.
Result<MeshContent> decode_mesh_wire(std::span<const std::span<const std::byte>> steps, const MeshLimits& limits = {});

}  // namespace citystream::codec::mesh
