// An approximation of what a tile's receivers get from far light: what it takes on the wire, and what it makes of a
// light.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "client/light/environment_map.h"
#include "codec/radiance/transfer.h"
#include "tests/bench/radiance_samples.h"

namespace citystream::bench {

struct IrradianceModel {
    std::string name;
    uint64_t bytes = 0;
    /// Of each receiver, from the radiance of each source texel.
    std::function<std::vector<client::LightSum>(std::span<const codec::radiance::Rgb> radiance)> irradiance;
};

/// Sample directions as irradiance needs them.
struct SampleDirections {
    std::vector<client::Direction> direction;  ///< unit vectors
    std::vector<double> solid_angle;
    std::vector<uint32_t> texel;

    explicit SampleDirections(uint32_t texels_across);
};

/// As their frames have them: unit vectors.
std::vector<client::Direction> receiver_normals(const codec::radiance::VisibilityTile& tile);

/// Three channels for each row of T: the product with a value for each texel.
using RowProduct = std::function<std::vector<std::array<double, 3>>(std::span<const std::array<double, 3>> light)>;
/// What a transfer matrix, or what stands for one, makes of light as the layer's passes do
/// (codec/radiance/irradiance.h), in double: products with light as a vector, summed over each receiver's rows, along
/// its normal. Rows are texels' parts, not quarters.
std::vector<client::LightSum> irradiance_by_vectors(std::span<const client::Direction> normals,
                                                    std::span<const codec::radiance::Rgb> radiance,
                                                    uint32_t texels_across, const RowProduct& product);

/// Added up from the bits, sample by sample: cosine and solid angle of each sample, radiance of its texel. What
/// approximations are measured against. Borrows the sample.
IrradianceModel exact_irradiance(const RadianceSample& sample);

}  // namespace citystream::bench
