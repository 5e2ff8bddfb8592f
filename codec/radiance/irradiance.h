// Irradiance of receivers from a layer's words and light in whole numbers: what the three light passes
// (client/render/radiance_passes.h) give, on the CPU. Bit for bit the same: all of it is integers, also the rounding to
// halves, so neither the order of sums nor a device's floats matter.
//
// Rows are multiplied with light as a vector (source_light.h). The sum of a receiver's rows is its vector irradiance,
// and the part along its normal the irradiance of its surface: each texel that it sees counts with its own cosine,
// whatever local direction it goes to. Light that varies within a texel apart, that is exact but for rounding.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/radiance_layer_layout.h"
#include "codec/radiance/source_light.h"

namespace citystream::codec::radiance {

/// Cosine of each local direction, averaged over what is nearest to it (local_directions.h), in 2^-16: below 2^16. For
/// what is made of light by local directions. `local_side`: 1..kMostLocalSide.
std::vector<uint32_t> irradiance_weights(uint32_t local_side);

/// The irradiance that 1 stands for, of each channel: a little more than all light there is, which no receiver exceeds.
std::array<float, 3> irradiance_unit(const WholeLight& light);

/// A receiver's normal in integers: `vector` times `scale` has the length 2^IRRADIANCE_SCALE_BITS within 3e-5 of it, of
/// normals along the axes 1e-6.
struct WholeNormal {
    std::array<int32_t, 3> vector{};
    uint32_t scale = 0;
};
/// As a receiver's class and tilts say (receiver_table.h).
WholeNormal whole_normal(uint32_t surface_class, const std::array<int8_t, 2>& tilt);
/// The part of a sum of light vectors (source_light.h) along a normal, in 2^-IRRADIANCE_WEIGHT_BITS of the light's
/// units, rounded down; 0 where it is less. Of vectors shorter than 2^30 it is below 2^47 (IRRADIANCE_SUM_BITS), give
/// or take the normal's error; of any below 2^50.
uint64_t part_along(const WholeNormal& normal, const std::array<uint32_t, 3>& vector);

/// Such a part as a half: nearest, of equals the greater. Below
/// 2^-14 halves are multiples of 2^-24.
uint32_t irradiance_half(uint64_t sum);
/// What a half of 0..1 stands for.
float half_value(uint32_t half);

/// IRRADIANCE_WORDS a receiver, as they go into the layer's words. Empty where the light is not of the layer's number
/// of texels, or that of no cube. O(matrix + receivers times local directions).
std::vector<uint32_t> irradiance_words(const RadianceLayerView& layer, const WholeLight& light);

/// A receiver's irradiance, of words that irradiance_words or the passes wrote.
std::array<float, 3> irradiance_of(std::span<const uint32_t> irradiance, uint32_t receiver,
                                   const std::array<float, 3>& unit);

}  // namespace citystream::codec::radiance
