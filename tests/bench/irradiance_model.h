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

/// What rows of T become with the weights that fold local directions to irradiance (cell_averages): `row_light` has
/// three channels for each row, radiance times solid angle.
std::vector<client::LightSum> irradiance_of_rows(std::span<const double> cosines,
                                                 std::span<const std::array<double, 3>> row_light);

/// Added up from the bits, sample by sample: cosine and solid angle of each sample, radiance of its texel. What
/// approximations are measured against. Borrows the sample.
IrradianceModel exact_irradiance(const RadianceSample& sample);

}  // namespace citystream::bench
