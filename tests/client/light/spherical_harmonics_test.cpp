#include "client/light/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

TEST(SphericalHarmonics, AreOrthonormal) {
    std::array<std::array<double, kHarmonics>, kHarmonics> products{};
    constexpr uint32_t kHeight = 200;
    for (uint32_t row = 0; row < kHeight; ++row) {
        for (uint32_t column = 0; column < 2 * kHeight; ++column) {
            const auto y = harmonics_at(map_direction(2 * kHeight, kHeight, column + 0.5, row + 0.5));
            const double solid_angle = map_solid_angle(2 * kHeight, kHeight, row);
            for (size_t i = 0; i < kHarmonics; ++i) {
                for (size_t j = 0; j <= i; ++j) products[i][j] += solid_angle * y[i] * y[j];
            }
        }
    }
    for (size_t i = 0; i < kHarmonics; ++i) {
        for (size_t j = 0; j <= i; ++j) EXPECT_NEAR(products[i][j], i == j ? 1 : 0, 1e-3) << i << " " << j;
    }
}

TEST(SphericalHarmonics, TheFirstNineAreThePrintedOnes) {
    // Ramamoorthi and Hanrahan, equation 3.
    const Direction d = direction_at(77, 23);
    const auto& [x, y, z] = d;
    const auto h = harmonics_at(d);
    EXPECT_NEAR(h[0], 0.282095, 1e-6);
    EXPECT_NEAR(h[1], 0.488603 * y, 1e-6);
    EXPECT_NEAR(h[2], 0.488603 * z, 1e-6);
    EXPECT_NEAR(h[3], 0.488603 * x, 1e-6);
    EXPECT_NEAR(h[4], 1.092548 * x * y, 1e-6);
    EXPECT_NEAR(h[5], 1.092548 * y * z, 1e-6);
    EXPECT_NEAR(h[6], 0.315392 * (3 * z * z - 1), 1e-6);
    EXPECT_NEAR(h[7], 1.092548 * x * z, 1e-6);
    EXPECT_NEAR(h[8], 0.546274 * (x * x - y * y), 1e-6);
}

TEST(SphericalHarmonics, AUniformSkyGivesPiOnEveryNormal) {
    for (const uint32_t height : {1U, 8U, 256U}) {
        const HarmonicLight light = harmonic_light(uniform_map(2 * height, height, {1, 2, 0}));
        for (const double azimuth : steps(0, 360, 37)) {
            for (const double up : steps(-90, 90, 15)) {
                for (const uint32_t bands : {1U, 3U, 5U}) {
                    const LightSum irradiance = light.irradiance(direction_at(azimuth, up), bands);
                    EXPECT_NEAR(irradiance[0], M_PI, 1e-3);
                    EXPECT_NEAR(irradiance[1], 2 * M_PI, 2e-3);
                    EXPECT_EQ(irradiance[2], 0);
                }
            }
        }
    }
}

TEST(SphericalHarmonics, IrradianceUnderAHalfSkyIsNearItsClosedForm) {
    // Light from above the horizon only: pi (1 + cos t) / 2 on a surface tilted by t.
    const HarmonicLight light = harmonic_light(made_map(256, 128, [](const Direction& d) {
        return d[2] > 0 ? Rgb{1, 1, 1} : Rgb{};
    }));
    for (const double tilt : steps(0, 180, 10)) {
        const double expected = M_PI * (1 + std::cos(tilt * M_PI / 180)) / 2;
        EXPECT_NEAR(light.irradiance(direction_at(30, 90 - tilt), 3)[0], expected, 0.03 * M_PI);
        EXPECT_NEAR(light.irradiance(direction_at(30, 90 - tilt), 5)[0], expected, 0.01 * M_PI);
    }
}

TEST(SphericalHarmonics, ParallelLightFallsOffWithTheCosineAsFarAsFiveBandsHoldIt) {
    HarmonicLight light;
    const Direction towards = direction_at(200, 35);
    add_parallel_light(light, towards, {1, 2, 3});
    for (const double angle : steps(0, 180, 15)) {
        const Direction normal = direction_at(200, 35 - angle);
        const double c = dot(normal, towards), irradiance = light.irradiance(normal, 5)[0];
        // Sum of (2l + 1) / (4 pi) A_l P_l(c).
        const double p2 = (3 * c * c - 1) / 2, p4 = (35 * c * c * c * c - 30 * c * c + 3) / 8;
        EXPECT_NEAR(irradiance, 1.0 / 4 + c / 2 + 5 * p2 / 16 - 9 * p4 / 96, 1e-12) << angle;
        EXPECT_NEAR(irradiance, std::max(c, 0.0), 0.06) << angle;
    }
    EXPECT_NEAR(light.irradiance(towards, 5)[2], 3 * light.irradiance(towards, 5)[0], 1e-12);
}

TEST(SphericalHarmonics, TurningIsLookingFromElsewhere) {
    const HarmonicLight light = harmonic_light(noise_map(32, 16));
    for (const double yaw : {0.4, -1.7, 5.0}) {
        const HarmonicLight turned = light.turned(yaw);
        for (const double azimuth : steps(0, 360, 53)) {
            const Direction d = direction_at(azimuth, azimuth / 4 - 40);
            expect_near(turned.radiance(turned_clockwise(d, yaw), 5), light.radiance(d, 5), 1e-9);
            expect_near(turned.irradiance(turned_clockwise(d, yaw), 3), light.irradiance(d, 3), 1e-9);
        }
    }
}

TEST(SphericalHarmonics, SmoothLightComesBack) {
    const HarmonicLight light = harmonic_light(made_map(256, 128, [](const Direction& d) {
        return Rgb{static_cast<float>(1 + d[0] * d[2]), static_cast<float>(1 + d[1]), 1};
    }));
    const Direction d = direction_at(66, -10);
    expect_near(light.radiance(d, 3), {1 + d[0] * d[2], 1 + d[1], 1}, 1e-3);
}

}  // namespace
}  // namespace citystream::client
