// Rows of the transfer matrix by their greatest Haar wavelets (Ng, Ramamoorthi and Hanrahan, All-Frequency Shadows
// Using Non-linear Wavelet Lighting Approximation, 2003, applied to rows of T as Sun et al. 2011, section 7, does with
// 12 terms a row).
#pragma once

#include "tests/bench/irradiance_model.h"

namespace citystream::bench {

/// The `terms` greatest coefficients of each row of each face's orthonormal, non-standard transform: a 16-bit number
/// and a 16-bit float each. Rows that are equal are kept once. Precondition: a power of two of texels across.
IrradianceModel haar_rows(const RadianceSample& sample, uint32_t local_side, uint32_t terms);

}  // namespace citystream::bench
