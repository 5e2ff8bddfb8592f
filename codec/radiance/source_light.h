// Light from far away, as the transfer takes it: a value a source texel and channel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/source_directions.h"

namespace citystream::codec::radiance {

using Rgb = std::array<float, 3>;

/// What a radiance map may hold: values that are not finite or below 0 become 0, greater ones than this become it.
inline constexpr float kMostRadiance = 1e30F;

/// Radiance times solid angle of each texel, so that the transfer itself holds nothing but quarters.
/// radiance.size() == texel_count(texels_across).
std::vector<Rgb> weighted_light(std::span<const Rgb> radiance, uint32_t texels_across);

/// The map in axes that are turned about z by `angle` (frames.h: a tile's yaw): each texel is the mean of 8 x 8
/// lookups. A uniform map stays as it is.
std::vector<Rgb> turned_light(std::span<const Rgb> radiance, uint32_t texels_across, double angle);

/// Light in whole numbers: sums of them are exact modulo 2^32, so that every way of adding them up (rows, clusters,
/// bits; in any order; CPU and GPU) gives the same number, nothing leaks from a bright texel into a row that does not
/// see it, and nothing becomes negative.
struct WholeLight {
    std::vector<std::array<uint32_t, 3>> values;
    std::array<double, 3> unit{};  ///< radiance times solid angle that 1 stands for, of each channel
};

/// The finest unit for which four times all of a channel stays below 2^31: what a row gathers in quarters. The error of
/// a row is at most half a unit a texel it sees. Takes weighted light.
WholeLight whole_light(std::span<const Rgb> weighted);

/// Light as a vector: x, y and z of each texel's direction times its light, two's complement, in two of the light's
/// units (radiance_layer_layout.h, LIGHT_VECTOR_SHIFT). Multiplied with the matrix each is a light of its own; the sum
/// of a receiver's rows is then its vector irradiance, of which the part along the normal is what arrives at the
/// surface. Sums stay below 2^30, so that their signs are what they seem also where a matrix errs by as much again.
using LightVectors = std::array<std::vector<std::array<uint32_t, 3>>, 3>;
/// cell_mean_direction of each texel. About 1 ms for 32 texels on a side.
std::vector<std::array<double, 3>> texel_directions(uint32_t texels_across);
/// Rounded: at most half of such a unit off. directions.size() == light.values.size().
LightVectors light_vectors(const WholeLight& light, std::span<const std::array<double, 3>> directions);

}  // namespace citystream::codec::radiance
