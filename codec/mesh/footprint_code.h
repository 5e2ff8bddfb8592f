// Footprints as range coded numbers: rings of points, mostly with right angles, next to others of the same directions.
//
// The outer ring starts at a point told as the difference from a point of the parent, a footprint told before
// (prism_order.h), in the parent's directions. Every other point is an edge: the quarter turn, the length, and how far
// the end is off the direction (footprint_frame.h). The last point of a ring is where it meets the start at a right
// angle, and what it is off. Each number is coded under several contexts at once (mixed_bits.h): turns before, what is
// still needed to close, lengths before, how regular the ring has been, and where between two grid points the expected
// one lies.
//
// Where a ring comes to a point of another one told before, it is first asked whether it goes on along that one's edge,
// the other way: houses share walls, and parts of roofs their edges.
//
// Any points can be told, also equal ones. Memory: a few hundred bytes for each point told.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "codec/bits/mixed_bits.h"
#include "codec/bits/range_coder.h"
#include "codec/mesh/footprint_frame.h"
#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

/// What those who come later need of one.
struct Footprint {
    std::vector<Ring> rings;
    FootprintFrame frame;
};

/// A number of either sign, mostly near 0, under mixed contexts.
class MixedSigned {
  public:
    explicit MixedSigned(std::initializer_list<uint32_t> context_counts)
        : size_(context_counts), sign_(context_counts, 2) {}
    void set_contexts(std::initializer_list<uint32_t> values) {
        size_.set_contexts(values);
        sign_.set_contexts(values);
    }
    /// |value| below 2^32.
    template <typename Coder>
    int64_t code(Coder& coder, int64_t value = 0) {
        const int64_t size = size_.code(coder, static_cast<uint32_t>(value < 0 ? -value : value));
        if (size == 0) return 0;
        return sign_.code(coder, size == 1 ? 0 : 1, value < 0 ? 1 : 0) != 0 ? -size : size;
    }

  private:
    bits::MixedNumbers size_;
    bits::MixedBits sign_;
};

class FootprintCode {
  public:
    FootprintCode();
    /// Codes a footprint (rings of at least 3 points); a decoder fills its rings, with at most `most_points` points.
    /// `parent` is null for the first one. `parent_point` is the point of the parent's outer ring next to its start;
    /// only an encoder's is used. False when what a decoder reads is no footprint.
    template <typename Coder>
    bool code(Coder& coder, Footprint& footprint, const Footprint* parent, uint32_t parent_point, uint32_t most_points);

  private:
    struct Walk;
    template <typename Coder>
    uint32_t code_size(Coder& coder, uint32_t size, uint32_t parent_size, uint32_t most);
    template <typename Coder>
    uint32_t code_parent_point(Coder& coder, uint32_t size, uint32_t point);
    template <typename Coder>
    PlaneVector code_start(Coder& coder, PlaneVector start, const Footprint& parent, uint32_t parent_point);
    template <typename Coder>
    bool code_ring(Coder& coder, Ring& ring, bool outer, FootprintFrame& frame);
    /// Whether the ring goes on, or closes, along an edge of a ring told before: true with the point.
    template <typename Coder>
    bool code_shared(Coder& coder, const Walk& walk, Ring& ring);
    void remember(const Footprint& footprint);
    template <typename Coder>
    uint32_t code_turn(Coder& coder, const Walk& walk, uint32_t turn, const FootprintFrame& frame);
    template <typename Coder>
    int64_t code_length(Coder& coder, const Walk& walk, int64_t length, const FootprintFrame& frame);
    template <typename Coder>
    int64_t code_off(Coder& coder, Walk& walk, int64_t length, int64_t across, const FootprintFrame& frame);

    using Point = std::array<int32_t, 2>;
    /// A point's neighbours on the rings that it is on, the last ring first.
    struct Neighbours {
        std::vector<Point> before, after;
    };
    std::map<Point, Neighbours> known_;
    bits::BitModel more_rings_[2], shared_[4][3];
    bits::MixedBits size_, parent_point_, turn_;
    MixedSigned start_along_, start_across_, hole_start_, length_, last_length_, off_;
    uint32_t last_parent_point_ = 0;
    uint32_t start_quarter_ = 0;  ///< of the parent's edge at its point
    uint32_t start_side_ = 0;     ///< on which side of that point the ring starts
};

}  // namespace citystream::codec::mesh
