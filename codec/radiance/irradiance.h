// Irradiance of receivers from a layer's words and light in whole numbers: what the three light passes
// (client/render/radiance_passes.h) give, on the CPU. Bit for bit the same: all of it is integers, also the rounding to
// halves, so neither the order of sums nor a device's floats matter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/radiance_layer_layout.h"
#include "codec/radiance/source_light.h"

namespace citystream::codec::radiance {

/// Cosine of each local direction, averaged over what is nearest to it (local_directions.h), in 2^-16: below 2^16.
/// `local_side`: 1..kMostLocalSide.
std::vector<uint32_t> irradiance_weights(uint32_t local_side);

/// The irradiance that 1 stands for, of each channel: a little more than all light there is, which no receiver exceeds.
std::array<float, 3> irradiance_unit(const WholeLight& light);

/// A sum of weights times rows, below 2^47 (IRRADIANCE_SUM_BITS), as a half: nearest, of equals the greater. Below
/// 2^-14 halves are multiples of 2^-24.
uint32_t irradiance_half(uint64_t sum);
/// What a half of 0..1 stands for.
float half_value(uint32_t half);

/// IRRADIANCE_WORDS a receiver, as they go into the layer's words. Empty where the light is not of the layer's number
/// of texels or `weights` not of its local directions. O(matrix + receivers times local directions).
std::vector<uint32_t> irradiance_words(const RadianceLayerView& layer, const WholeLight& light,
                                       std::span<const uint32_t> weights);

/// A receiver's irradiance, of words that irradiance_words or the passes wrote.
std::array<float, 3> irradiance_of(std::span<const uint32_t> irradiance, uint32_t receiver,
                                   const std::array<float, 3>& unit);

}  // namespace citystream::codec::radiance
