#include "tests/bench/harmonic_transfer.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "client/light/spherical_harmonics.h"
#include "tests/bench/coded_halves.h"

namespace citystream::bench {

using client::harmonics_at;
using client::LightSum;
using codec::radiance::Rgb;

namespace {

/// Coefficient i of receiver r at i * receivers + r.
std::vector<double> projected(const RadianceSample& sample, const SampleDirections& directions, uint32_t count) {
    const auto& tile = sample.visibility;
    std::vector<std::array<double, client::kHarmonics>> basis;
    for (const auto& direction : directions.direction) basis.push_back(harmonics_at(direction));
    const auto normals = receiver_normals(tile);
    std::vector<double> coefficients(size_t{count} * tile.receivers());
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const auto words = tile.of(r);
        std::array<double, client::kHarmonics> sums{};
        for (uint32_t w = 0; w < words.size(); ++w) {
            for (uint32_t bits = words[w]; bits != 0; bits &= bits - 1) {
                const uint32_t s = 32 * w + static_cast<uint32_t>(std::countr_zero(bits));
                const double weight =
                    directions.solid_angle[s] * std::max(0.0, client::dot(normals[r], directions.direction[s]));
                for (uint32_t i = 0; i < count; ++i) sums[i] += weight * basis[s][i];
            }
        }
        for (uint32_t i = 0; i < count; ++i) coefficients[size_t{i} * tile.receivers() + r] = sums[i];
    }
    return coefficients;
}

}  // namespace

IrradianceModel harmonic_transfer(const RadianceSample& sample, uint32_t bands) {
    const uint32_t count = bands * bands, receivers = sample.visibility.receivers();
    const auto directions = std::make_shared<const SampleDirections>(sample.visibility.side);
    std::vector<uint16_t> halves;
    for (const double value : projected(sample, *directions, count))
        halves.push_back(to_half(static_cast<float>(value)));
    return {"sh-" + std::to_string(count), coded_bytes(halves),
            [count, receivers, directions, halves](std::span<const Rgb> radiance) {
                std::array<LightSum, client::kHarmonics> light{};
                for (size_t s = 0; s < directions->texel.size(); ++s) {
                    const auto basis = harmonics_at(directions->direction[s]);
                    const Rgb& value = radiance[directions->texel[s]];
                    for (uint32_t i = 0; i < count; ++i) {
                        for (size_t c = 0; c < 3; ++c) light[i][c] += directions->solid_angle[s] * basis[i] * value[c];
                    }
                }
                std::vector<LightSum> result(receivers);
                for (uint32_t i = 0; i < count; ++i) {
                    for (uint32_t r = 0; r < receivers; ++r) {
                        const double coefficient = from_half(halves[size_t{i} * receivers + r]);
                        for (size_t c = 0; c < 3; ++c) result[r][c] += coefficient * light[i][c];
                    }
                }
                return result;
            }};
}

}  // namespace citystream::bench
