// Lossless topology of a triangle mesh in about 3 to 6 bits a triangle that a GPU decodes by scans (Meyer 2012, chapter
// 5; the notes' T3 to T9): the strips of strips.h as steps, new vertices and differences of old ones in Simple-9 words.
// strip_layout.h has the words.
//
// Beyond the paper: a restart beside a vertex of the triangle before takes two triangles with equal corners in place of
// four; differences may be predicted as +1; Simple-9 is packed by the shortest path; rotations of restarts are chosen
// by what they cost.
//
// Untrusted words: the header is checked against the words there are before anything is allocated, every step, code and
// reference is checked, and the work is linear in the number of words. What is accepted decodes to corners < vertices.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/mesh/strips.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// In place of a StripTriangle's index: a triangle with two equal corners that only emulates a restart.
inline constexpr uint32_t kPutIn = ~uint32_t{0};

struct StripCode {
    std::vector<uint32_t> words;        ///< as in strip_layout.h
    std::vector<StripTriangle> stream;  ///< what the triangles of the stream are in the input; kPutIn: nothing
    std::vector<uint32_t> vertices;     ///< input vertex of each new number: attributes have to follow this order
};

/// What to choose by hand; otherwise whatever takes the fewest words. Restart codes are taken, too, where the input has
/// triangles with equal corners, which nobody could tell from those put in.
struct StripCodeOptions {
    std::optional<uint32_t> mode;             ///< STRIP_MODE_RESTARTS, STRIP_MODE_DEGENERATES
    std::optional<uint32_t> prediction;       ///< of a difference: 0, 1
    std::optional<StripTraversal> traversal;  ///< of strips.h
};

/// Precondition: every corner < vertex_count. Fails for more than 2^27 vertices or 2^28 triangles in the stream.
Result<StripCode> encode_strips(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count,
                                const StripCodeOptions& options = {});

/// The header, and where the parts begin (in words).
struct StripHeader {
    uint32_t triangles = 0, references = 0, explicit_references = 0, code_words = 0;
    uint32_t mode = 0, prediction = 0, vertices = 0;
    size_t codes_at = 0, increments_at = 0, steps_at = 0, words = 0;
};

/// Checks magic, limits and that the counts come to exactly words.size() words; not what they say.
Result<StripHeader> read_strip_header(std::span<const uint32_t> words);

/// Checks everything: words that pass can be given to the GPU.
Status check_strip_code(std::span<const uint32_t> words);

using CornerList = std::vector<std::array<uint32_t, 3>>;
/// All triangles of the stream, those put in included, one after the other: the plain decoder.
Result<CornerList> decode_strips(std::span<const uint32_t> words);
/// The same triangles in the stages of the GPU decoder, each of which needs only scans and independent elements (T9).
Result<CornerList> decode_strips_staged(std::span<const uint32_t> words);

}  // namespace citystream::codec::mesh
