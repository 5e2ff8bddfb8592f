// The root of CIE L*a*b*, for loops over pixels.
#pragma once

#include <cmath>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

/// f(t) of CIE L*a*b*: cube root above (6 / 29)^3, a line below; t in 0..1 (up to rounding). Within 4e-7.
inline CITYSTREAM_INLINED float lab_root(float t) {
    // The root in terms of q = t^(1/4): q^(4/3), by the polynomial that meets it at the eight Chebyshev nodes between
    // the joint and 1.
    const float q = std::sqrt(std::sqrt(t > 0 ? t : 0));
    const float high = 1.32114955f + q * (-0.925918769f + q * (0.381031276f + q * -0.0689938396f));
    const float root = -0.00891258077f + q * (0.44219659f + q * (1.14545788f + q * (-1.2860102f + q * high)));
    return t > 216.0f / 24389 ? root : t * (841.0f / 108) + 4.0f / 29;
}

}  // namespace citystream::codec::atlas
