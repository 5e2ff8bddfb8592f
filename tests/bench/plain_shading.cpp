#include "tests/bench/plain_shading.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <numbers>

#include "client/light/spherical_harmonics.h"
#include "codec/bits/zstd_frame.h"

namespace citystream::bench {

using client::Direction;
using client::HarmonicLight;
using client::LightSum;
using codec::radiance::Rgb;

namespace {

constexpr uint32_t kBands = 3;

/// The light but for one texel.
HarmonicLight harmonics_without(std::span<const Rgb> radiance, const SampleDirections& directions, uint32_t left_out) {
    HarmonicLight light;
    for (size_t s = 0; s < directions.texel.size(); ++s) {
        if (directions.texel[s] == left_out) continue;
        const Rgb& value = radiance[directions.texel[s]];
        const double weight = directions.solid_angle[s];
        client::add_parallel_light(light, directions.direction[s],
                                   {weight * value[0], weight * value[1], weight * value[2]});
    }
    return light;
}

/// By the normal alone, without anything in the way.
LightSum open_irradiance(std::span<const Rgb> radiance, const SampleDirections& directions, const Direction& normal) {
    LightSum sum{};
    for (size_t s = 0; s < directions.texel.size(); ++s) {
        const double weight = directions.solid_angle[s] * std::max(0.0, client::dot(normal, directions.direction[s]));
        for (size_t c = 0; c < 3; ++c) sum[c] += weight * radiance[directions.texel[s]][c];
    }
    return sum;
}

uint32_t brightest_texel(std::span<const Rgb> radiance) {
    const auto brightest = std::max_element(radiance.begin(), radiance.end(), [](const Rgb& a, const Rgb& b) {
        return client::luminance(a) < client::luminance(b);
    });
    return static_cast<uint32_t>(brightest - radiance.begin());
}

/// A receiver's occlusion and bent normal as four bytes, and back.
using Bent = std::array<uint8_t, 4>;

Bent bent_of(const RadianceSample& sample, const SampleDirections& directions, uint32_t receiver,
             const Direction& normal) {
    const auto words = sample.visibility.of(receiver);
    double open = 0;
    Direction mean{};
    for (uint32_t w = 0; w < words.size(); ++w) {
        for (uint32_t bits = words[w]; bits != 0; bits &= bits - 1) {
            const uint32_t s = 32 * w + static_cast<uint32_t>(std::countr_zero(bits));
            const double weight =
                directions.solid_angle[s] * std::max(0.0, client::dot(normal, directions.direction[s]));
            open += weight;
            for (size_t c = 0; c < 3; ++c) mean[c] += weight * directions.direction[s][c];
        }
    }
    const double length = std::sqrt(client::dot(mean, mean));
    Bent bent{};
    bent[0] = static_cast<uint8_t>(std::lround(255 * std::min(1.0, open / std::numbers::pi)));
    for (size_t c = 0; c < 3; ++c)
        bent[c + 1] = static_cast<uint8_t>(128 + std::lround(127 * (length > 0 ? mean[c] / length : normal[c])));
    return bent;
}

Direction direction_of(const Bent& bent) {
    const Direction d = {bent[1] - 128.0, bent[2] - 128.0, bent[3] - 128.0};
    const double length = std::sqrt(client::dot(d, d));
    return {d[0] / length, d[1] / length, d[2] / length};
}

}  // namespace

IrradianceModel ambient_light(const RadianceSample& sample) {
    const auto directions = std::make_shared<const SampleDirections>(sample.visibility.side);
    const auto& tile = sample.visibility;
    return {"ambient", 0, [&tile, directions](std::span<const Rgb> radiance) {
                const HarmonicLight light = harmonics_without(radiance, *directions, ~0U);
                std::vector<LightSum> result;
                for (const Direction& normal : receiver_normals(tile))
                    result.push_back(light.irradiance(normal, kBands));
                return result;
            }};
}

IrradianceModel shadow_map_only(const RadianceSample& sample) {
    const auto directions = std::make_shared<const SampleDirections>(sample.visibility.side);
    const auto& tile = sample.visibility;
    return {"shadow-map", 0, [&tile, directions](std::span<const Rgb> radiance) {
                const uint32_t sun = brightest_texel(radiance);
                const HarmonicLight light = harmonics_without(radiance, *directions, sun);
                const auto normals = receiver_normals(tile);
                std::vector<LightSum> result;
                for (uint32_t r = 0; r < tile.receivers(); ++r) {
                    result.push_back(light.irradiance(normals[r], kBands));
                    for (uint32_t s = 0; s < directions->texel.size(); ++s) {
                        if (directions->texel[s] != sun || !tile.sees(r, s)) continue;
                        const double weight = directions->solid_angle[s] *
                                              std::max(0.0, client::dot(normals[r], directions->direction[s]));
                        for (size_t c = 0; c < 3; ++c) result.back()[c] += weight * radiance[sun][c];
                    }
                }
                return result;
            }};
}

IrradianceModel bent_normals(const RadianceSample& sample) {
    const auto directions = std::make_shared<const SampleDirections>(sample.visibility.side);
    const auto normals = receiver_normals(sample.visibility);
    std::vector<Bent> bent;
    for (uint32_t r = 0; r < sample.visibility.receivers(); ++r)
        bent.push_back(bent_of(sample, *directions, r, normals[r]));
    uint64_t bytes = 0;
    for (size_t i = 0; i < 4; ++i) {
        std::vector<std::byte> plane;
        for (const Bent& one : bent) plane.push_back(static_cast<std::byte>(one[i]));
        bytes += codec::bits::compress_frame(plane).size();
    }
    return {"occlusion-bent-normal", bytes, [directions, bent](std::span<const Rgb> radiance) {
                std::vector<LightSum> result;
                for (const Bent& one : bent) {
                    LightSum light = open_irradiance(radiance, *directions, direction_of(one));
                    for (double& channel : light) channel *= one[0] / 255.0;
                    result.push_back(light);
                }
                return result;
            }};
}

}  // namespace citystream::bench
