// The adaptive-precision buffer: words of B bits, cut to a bit level that can change, packed without padding (Meyer
// 2012, sections 3.3.3, 3.4.2, 3.5.4 and 3.6.2). It is drawn as it is: shaders/precision_fetch.glsl is the twin of
// PrecisionView, shaders/precision_merge.comp.glsl of change_level.
//
// Vertices lie in *bins* of rising least level: at buffer level b the vertices of a bin hold max(b, its least level)
// bits. One bin of least level 0 or 1 is plain adaptive precision (AP); more of them are the binned buffer of
// constrained precision (binned_buffer.h).
//
// A component whose words are all below 2^(B - k) has k *leading* zeros, which are not stored: at level b it takes
// max(b - k, 0) bits. (The paper stores them; without any it is the paper's buffer: 3 b bits a vertex.)
//
// Words of a buffer (precision_layout.h): header of 4, two a bin, then the payload: vertex by vertex, component by
// component, least significant bit first; unused bits are 0.
//
// A *plane* l holds bit l (0: the most significant of B) of all vertices that get it when the buffer goes from level l
// to l + 1: those in bins of least level <= l, which are the first ones, n. Component by component, n bits each (of
// components with at most l leading zeros), one after the other, padded to a word: 3 bits a vertex.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/precision_layout.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct PrecisionBin {
    uint32_t first_vertex = 0;
    uint32_t least_level = 0;
    friend bool operator==(const PrecisionBin&, const PrecisionBin&) = default;
};

/// All of a buffer but its level and its payload.
struct PrecisionShape {
    uint32_t vertices = 0;                                      ///< below 2^27
    uint32_t components = 3;                                    ///< 1..4
    uint32_t full_bits = 0;                                     ///< B, 1..31
    std::array<uint32_t, PRECISION_MOST_COMPONENTS> leading{};  ///< zeros, 0..B
    /// Not empty, first vertices and least levels rise strictly, the first one begins at 0; only a buffer without
    /// vertices has an empty bin.
    std::vector<PrecisionBin> bins = {{}};

    uint32_t bin_level(size_t bin, uint32_t level) const { return std::max(bins[bin].least_level, level); }
    uint32_t bin_end(size_t bin) const { return bin + 1 < bins.size() ? bins[bin + 1].first_vertex : vertices; }
    /// Bits of one component, and of one vertex, at the level of its bin.
    uint32_t field_bits(uint32_t component, uint32_t level) const {
        return level - std::min(level, leading[component]);
    }
    uint32_t record_bits(uint32_t level) const;
    uint32_t header_words() const;
    /// Below 2^39.
    uint64_t payload_bits(uint32_t level) const;
    /// Of the whole buffer.
    uint64_t words_at(uint32_t level) const;
    /// Vertices that plane l has bits of, and its words.
    uint32_t plane_vertices(uint32_t plane) const;
    uint64_t plane_words(uint32_t plane) const;
    /// Words that must be sent to go from one level to another: 0 downwards.
    uint64_t words_between(uint32_t from, uint32_t to) const;
    friend bool operator==(const PrecisionShape&, const PrecisionShape&) = default;
};

/// Whether a buffer of this shape may exist: the ranges above, and at full level at most 2^32 - 1 bits.
Status check_shape(const PrecisionShape& shape);

/// Packs words (vertex by vertex, `components` each, below 2^(B - leading)) at a level of 0..B. Precondition:
/// check_shape. O(words).
std::vector<uint32_t> pack_precision(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t level);

/// Plane l < B of the same words.
std::vector<uint32_t> precision_plane(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t plane);

/// The header that a buffer of this shape has at a level.
std::vector<uint32_t> precision_header(const PrecisionShape& shape, uint32_t level);

/// What a header says: all of a buffer but its payload.
struct PrecisionHeader {
    PrecisionShape shape;
    uint32_t level = 0;
};

/// The checked header that `words` begin with, whatever follows it. Error: a header that no shape has.
Result<PrecisionHeader> read_precision_header(std::span<const uint32_t> words);

/// A checked view of a buffer's words: neither it nor the shader can read outside them, whatever they are.
class PrecisionView {
  public:
    /// Error: a header that no shape has, a length that does not fit, unused bits that are set.
    static Result<PrecisionView> create(std::span<const uint32_t> words);

    const PrecisionShape& shape() const { return shape_; }
    uint32_t level() const { return level_; }
    /// A vertex's words, bits that are not there 0. Returns the bit level that it has. Random access, O(log bins).
    uint32_t fetch(uint32_t vertex, std::span<uint32_t> out) const;

  private:
    std::span<const uint32_t> words_;
    PrecisionShape shape_;
    uint32_t level_ = 0;
};

/// The buffer at another level, 0..B. Upwards `planes` holds planes level..to_level - 1, exactly words_between of them;
/// downwards none. Error where their number is not that. O(words).
Result<std::vector<uint32_t>> change_level(const PrecisionView& buffer, uint32_t to_level,
                                           std::span<const uint32_t> planes);

}  // namespace citystream::codec::mesh
