#include "codec/radiance/source_light.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "codec/radiance/frames.h"
#include "codec/radiance/radiance_layer_layout.h"

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kLookupsAcross = 8;

float sound_radiance(float v) {
    return v > 0 ? std::min(v, kMostRadiance) : 0;
}

}  // namespace

std::vector<Rgb> weighted_light(std::span<const Rgb> radiance, uint32_t texels_across) {
    assert(radiance.size() == texel_count(texels_across));
    std::vector<Rgb> weighted(radiance.size());
    for (uint32_t k = 0; k < weighted.size(); ++k) {
        const auto solid_angle = static_cast<float>(cell_solid_angle(texels_across, k));
        for (size_t c = 0; c < 3; ++c) weighted[k][c] = sound_radiance(radiance[k][c]) * solid_angle;
    }
    return weighted;
}

std::vector<Rgb> turned_light(std::span<const Rgb> radiance, uint32_t texels_across, double angle) {
    assert(radiance.size() == texel_count(texels_across));
    const uint32_t fine = kLookupsAcross * texels_across;
    std::vector<std::array<double, 3>> sums(radiance.size());
    std::vector<double> weights(radiance.size());
    for (uint32_t cell = 0; cell < cube_cells(fine); ++cell) {
        const uint32_t column = cell % fine, row = cell / fine % fine, face = cell / fine / fine;
        const uint32_t texel = (face * texels_across + row / kLookupsAcross) * texels_across + column / kLookupsAcross;
        const GridDirection d = cell_direction(fine, cell);
        const auto there =
            turned({static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])}, angle);
        const Rgb& value = radiance[cell_of(there, texels_across)];
        const double weight = cell_solid_angle(fine, cell);
        weights[texel] += weight;
        for (size_t c = 0; c < 3; ++c) sums[texel][c] += weight * sound_radiance(value[c]);
    }
    std::vector<Rgb> result(radiance.size());
    for (size_t k = 0; k < result.size(); ++k) {
        for (size_t c = 0; c < 3; ++c) result[k][c] = static_cast<float>(sums[k][c] / weights[k]);
    }
    return result;
}

WholeLight whole_light(std::span<const Rgb> weighted) {
    WholeLight light;
    std::array<double, 3> totals{};
    for (const Rgb& value : weighted) {
        for (size_t c = 0; c < 3; ++c) totals[c] += value[c];
    }
    // Half a unit a texel may be added by rounding.
    const double room = (2147483647.0 / kSamplesInTexel) - static_cast<double>(weighted.size());
    for (size_t c = 0; c < 3; ++c) light.unit[c] = totals[c] > 0 ? totals[c] / room : 1;
    light.values.resize(weighted.size());
    for (size_t k = 0; k < weighted.size(); ++k) {
        for (size_t c = 0; c < 3; ++c)
            light.values[k][c] = static_cast<uint32_t>(std::floor(weighted[k][c] / light.unit[c] + 0.5));
    }
    return light;
}

std::vector<std::array<double, 3>> texel_directions(uint32_t texels_across) {
    std::vector<std::array<double, 3>> directions(texel_count(texels_across));
    for (uint32_t k = 0; k < directions.size(); ++k) directions[k] = cell_mean_direction(texels_across, k);
    return directions;
}

LightVectors light_vectors(const WholeLight& light, std::span<const std::array<double, 3>> directions) {
    assert(directions.size() == light.values.size());
    LightVectors vectors;
    for (size_t axis = 0; axis < vectors.size(); ++axis) {
        vectors[axis].resize(light.values.size());
        for (size_t k = 0; k < light.values.size(); ++k) {
            for (size_t c = 0; c < 3; ++c) {
                const double value =
                    std::floor(light.values[k][c] * directions[k][axis] / (1 << LIGHT_VECTOR_SHIFT) + 0.5);
                vectors[axis][k][c] = static_cast<uint32_t>(static_cast<int64_t>(value));
            }
        }
    }
    return vectors;
}

}  // namespace citystream::codec::radiance
