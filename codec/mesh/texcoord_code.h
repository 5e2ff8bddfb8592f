// Texture coordinates of the corners of a mesh as range coded decisions.
//
// A corner mostly has what a corner at the same point has in a neighbour of the same chart. Else each axis is compared
// with what the surroundings suggest exactly: where the neighbour's mapping from places to texture coordinates takes
// the point (its parallelogram, else affine), what the triangle's other corners have, the image's ends 0 and 2^16, the
// least and the greatest coordinate met in the chart. What is none of these is coded as the difference to the mapping.
// Which of the guesses is right mostly follows from where the corner lies in its triangle, as seen from outside: left
// or right, low or high.
//
// Of each chart the low bits that all its coordinates have in common are told once an axis, as the number of bits, and
// left out of differences. One template for writer and reader (range_coder.h); any bytes give some coordinates. O(1) a
// corner. Lossless for any int32 coordinates.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>

#include "codec/bits/mixed_bits.h"
#include "codec/bits/range_coder.h"
#include "codec/mesh/place_predictor.h"

namespace citystream::codec::mesh {

using Texcoord = std::array<int32_t, 2>;  ///< 2^-16 repeats of the chart's image

/// What is met in one chart.
struct ChartTexcoords {
    bool begun = false;
    Texcoord first{}, least{}, greatest{};
    std::array<uint32_t, 2> common_bits{};  ///< low bits in which all differences to `first` are 0
};

/// A corner that is to be told.
struct TexcoordPlace {
    uint32_t ordinal = 0;               ///< how many corners of the triangle are known
    std::array<Texcoord, 2> earlier{};  ///< of those that are
    std::array<uint32_t, 2> side{};     ///< by axis, as seen from outside: 0 lowest, 1 highest, 2 between
    std::array<uint32_t, 2> level{};    ///< by axis: bit i: on one height with the i-th earlier corner
    bool is_mapped = false;             ///< a neighbour's mapping is known
    bool is_parallelogram = false;      ///< the mapping is exact as far as known positions say
    Texcoord mapped{};
};

class TexcoordCode {
  public:
    /// Tells the common bits of a chart that is new; a writer has found them.
    template <typename Coder>
    void code_chart(Coder& coder, ChartTexcoords& chart);
    /// Whether a corner has what an earlier one at its point has in the same chart. `kind` is below 4.
    template <typename Coder>
    bool code_same(Coder& coder, uint32_t kind, bool same) {
        return coder.bit(same_[kind], same ? 1 : 0) != 0;
    }
    /// The coordinates themselves.
    template <typename Coder>
    Texcoord code(Coder& coder, ChartTexcoords& chart, const TexcoordPlace& place, Texcoord texcoord = {});
    /// A chart's coordinates met otherwise.
    static void meet(ChartTexcoords& chart, const Texcoord& texcoord);

  private:
    enum Guess : uint32_t { kMapped, kFirstCorner, kSecondCorner, kZero, kOne, kLeast, kGreatest, kGuesses };
    template <typename Coder>
    int32_t code_axis(Coder& coder, const ChartTexcoords& chart, const TexcoordPlace& place, uint32_t axis,
                      int32_t value);

    bits::BitModel same_[4];
    bits::MixedBits hits_{{2 * kGuesses * 3 * 3 * 4, 2 * kGuesses * 64, kGuesses * 12 * 2, 2 * kGuesses * 3 * 8 * 3},
                          1};
    bits::MixedNumbers rests_{{2 * 2 * 3, 24, 2 * 32}};
    bits::BitModel up_[2];
    bits::BitModel same_bits_[2];
    bits::BitTree common_bits_{32};
    std::array<uint32_t, 2> last_bits_ = {16, 16};
    std::array<uint32_t, 2> history_{}, last_size_{};
};

template <typename Coder>
void TexcoordCode::code_chart(Coder& coder, ChartTexcoords& chart) {
    for (size_t axis = 0; axis < 2; ++axis) {
        uint32_t& told = chart.common_bits[axis];
        if (coder.bit(same_bits_[axis], told == last_bits_[axis] ? 1 : 0) != 0)
            told = last_bits_[axis];
        else
            told = common_bits_.code(coder, told);
        last_bits_[axis] = told;
    }
}

inline void TexcoordCode::meet(ChartTexcoords& chart, const Texcoord& texcoord) {
    for (size_t axis = 0; axis < 2; ++axis) {
        const int32_t value = texcoord[axis];
        chart.least[axis] = chart.begun ? std::min(chart.least[axis], value) : value;
        chart.greatest[axis] = chart.begun ? std::max(chart.greatest[axis], value) : value;
        if (!chart.begun) chart.first[axis] = value;
    }
    chart.begun = true;
}

template <typename Coder>
Texcoord TexcoordCode::code(Coder& coder, ChartTexcoords& chart, const TexcoordPlace& place, Texcoord texcoord) {
    for (uint32_t axis = 0; axis < 2; ++axis) texcoord[axis] = code_axis(coder, chart, place, axis, texcoord[axis]);
    meet(chart, texcoord);
    return texcoord;
}

template <typename Coder>
int32_t TexcoordCode::code_axis(Coder& coder, const ChartTexcoords& chart, const TexcoordPlace& place, uint32_t axis,
                                int32_t value) {
    const uint32_t shift = chart.begun ? chart.common_bits[axis] : 0;
    const auto difference = [](int32_t a, int32_t b) { return static_cast<uint32_t>(a) - static_cast<uint32_t>(b); };
    const uint32_t mask = (uint32_t{1} << shift) - 1;
    std::array<int32_t, kGuesses> told{};
    uint32_t count = 0;
    const uint32_t side = place.side[axis], level = place.level[axis];
    const uint32_t mapped = !place.is_mapped ? 0 : place.is_parallelogram ? 2 : 1;
    uint32_t hit = kGuesses;
    const auto ask = [&](Guess guess, int32_t candidate) {
        if (hit != kGuesses || (chart.begun && (difference(candidate, chart.first[axis]) & mask) != 0)) return;
        if (std::find(told.begin(), told.begin() + count, candidate) != told.begin() + count) return;
        told[count++] = candidate;
        const uint32_t at = axis * kGuesses + guess;
        hits_.set_contexts({((at * 3 + side) * 3 + place.ordinal) * 4 + level, at * 64 + (history_[axis] & 63),
                            (guess * 12 + place.ordinal * 4 + level) * 2 + (chart.begun ? 1u : 0u),
                            ((at * 3 + side) * 8 + (history_[axis] & 7)) * 3 + mapped});
        if (hits_.code(coder, 0, value == candidate ? 1 : 0) == 0) return;
        hit = guess;
        value = candidate;
    };
    if (place.is_mapped) ask(kMapped, place.mapped[axis]);
    if (place.ordinal > 0) ask(kFirstCorner, place.earlier[0][axis]);
    if (place.ordinal > 1) ask(kSecondCorner, place.earlier[1][axis]);
    ask(kZero, 0);
    ask(kOne, 1 << 16);
    if (chart.begun) ask(kLeast, chart.least[axis]);
    if (chart.begun) ask(kGreatest, chart.greatest[axis]);
    history_[axis] = history_[axis] << 3 | std::min(hit, 7u);
    if (hit != kGuesses) return value;

    int32_t expected = place.is_mapped ? place.mapped[axis] : place.ordinal > 0 ? place.earlier[0][axis] : 0;
    if (chart.begun)
        expected =
            static_cast<int32_t>(static_cast<uint32_t>(expected) - (difference(expected, chart.first[axis]) & mask));
    const auto rest = static_cast<int32_t>(difference(value, expected)) >> shift;
    const uint32_t kind = mapped > 0 ? 1 : 0;
    rests_.set_contexts({(axis * 2 + kind) * 3 + place.ordinal, shift < 24 ? shift : 23, kind * 32 + last_size_[axis]});
    const uint32_t size = rests_.code(coder, rest < 0 ? 0u - static_cast<uint32_t>(rest) : static_cast<uint32_t>(rest));
    last_size_[axis] = std::min(static_cast<uint32_t>(std::bit_width(size)), 31u);
    const bool up = size == 0 || coder.bit(up_[axis], rest > 0 ? 1 : 0) != 0;
    const uint32_t change = size << shift;
    return static_cast<int32_t>(static_cast<uint32_t>(expected) + (up ? change : 0u - change));
}

}  // namespace citystream::codec::mesh
