// Lossless topology with random access: the three vertices of any triangle from a bounded number of words (at most some
// thirty), so that a vertex shader can draw it without any pass before. In groups of 64 triangles the strips of
// strips.h as bits: the strip's last turn is found by the highest set bit, new vertices are numbered by counting bits,
// the others have fields of one width a group, relative to a vertex or to the newest one. local_strips_layout.h has the
// words, shaders/local_strips.glsl the twin of local_triangle. Takes 1.1 to 1.8 times the bits of strip_code.h.
//
// Beyond the paper, which decodes whole meshes only; of the family of DGF's blocks and of meshlet codecs.
//
// Untrusted words: check_local_strips looks at everything, in linear time; what it accepts yields corners < vertices
// for every triangle.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/strips.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct LocalStrips {
    std::vector<uint32_t> words;        ///< as in local_strips_layout.h
    std::vector<StripTriangle> stream;  ///< what the triangles are in the input; nothing is put in
    std::vector<uint32_t> vertices;     ///< input vertex of each new number
};

/// Precondition: every corner < vertex_count. Fails for more than 2^27 vertices or triangles.
Result<LocalStrips> encode_local_strips(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count);

/// Checks that every triangle can be read and that the words are what an encoder would have laid out.
Status check_local_strips(std::span<const uint32_t> words);

/// The corners of one triangle. Preconditions: check_local_strips accepts the words, index < the triangles they have.
std::array<uint32_t, 3> local_triangle(std::span<const uint32_t> words, uint32_t index);

/// All triangles.
Result<std::vector<std::array<uint32_t, 3>>> decode_local_strips(std::span<const uint32_t> words);

}  // namespace citystream::codec::mesh
