// Low-order transfer: visibility times cosine in the first spherical harmonics, a vector a receiver (Sloan, Kautz and
// Snyder, Precomputed Radiance Transfer for Real-Time Rendering in Dynamic, Low-Frequency Lighting Environments, 2002,
// equation 7 without interreflection). The low-order bi-scale transfer that the paper compares with holds such a vector
// for each local direction; folded with the cosine, as here, it is the same irradiance for 1 / M of the bytes.
#pragma once

#include "tests/bench/irradiance_model.h"

namespace citystream::bench {

/// `bands`: 1..5, bands^2 coefficients a receiver, 16-bit floats. Light is projected on as many.
IrradianceModel harmonic_transfer(const RadianceSample& sample, uint32_t bands);

}  // namespace citystream::bench
