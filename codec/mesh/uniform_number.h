// Uniformly quantised numbers over a range of reals (Meyer 2012, section 2.3.2), for input that is not on the grid.
#pragma once

#include <cstdint>

namespace citystream::codec::mesh {

/// 2^bits numbers evenly from `low` to `high`, both of them included (Eq. 2.4, 2.5). Finite, low <= high, bits 1..32.
struct UniformRange {
    double low = 0, high = 1;
    uint32_t bits = 16;

    /// Distance between two numbers; 0 where the range is one point.
    double step() const;
    /// The nearest number's index. Eq. 2.6 with the erratum: floor(x + 1/2) clamped, the sign of x adds nothing. What
    /// lies outside the range goes to its end, no number (NaN) to index 0.
    uint32_t pack(double value) const;
    double unpack(uint32_t index) const;
};

/// Bits of a uniform number that match floats with `mantissa_bits` stored bits at their coarsest spacing, sign included
/// (section 3.3.1): 25 for single precision.
constexpr uint32_t bits_to_match_floats(uint32_t mantissa_bits) {
    return mantissa_bits + 2;
}

/// Spacing of single-precision floats at `magnitude` (normal, finite): the coarsest one of a model is at its largest
/// coordinate.
double float_spacing(double magnitude);

}  // namespace citystream::codec::mesh
