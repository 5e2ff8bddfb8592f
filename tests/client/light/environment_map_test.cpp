#include "client/light/environment_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

TEST(EnvironmentMap, TheMiddleOfThePictureIsNorthAndEastIsRightOfIt) {
    const auto is = [](const Direction& d, double x, double y, double z) {
        EXPECT_NEAR(d[0], x, 1e-12);
        EXPECT_NEAR(d[1], y, 1e-12);
        EXPECT_NEAR(d[2], z, 1e-12);
    };
    is(map_direction(8, 4, 4, 2), 0, 1, 0);
    is(map_direction(8, 4, 6, 2), 1, 0, 0);
    is(map_direction(8, 4, 2, 2), -1, 0, 0);
    is(map_direction(8, 4, 0, 2), 0, -1, 0);
    is(map_direction(8, 4, 8, 2), 0, -1, 0);
    is(map_direction(8, 4, 5, 0), 0, 0, 1);
    is(map_direction(8, 4, 5, 4), 0, 0, -1);
}

TEST(EnvironmentMap, SolidAnglesAddUpToTheSphere) {
    for (const uint32_t height : {1U, 2U, 7U, 512U}) {
        double sum = 0;
        for (uint32_t row = 0; row < height; ++row) sum += 2 * height * map_solid_angle(2 * height, height, row);
        EXPECT_NEAR(sum, 4 * M_PI, 1e-12);
    }
}

TEST(EnvironmentMap, LookupsAreTheTexelsAtTheirCentres) {
    const EnvironmentMap map = noise_map(16, 8);
    for (uint32_t row = 0; row < 8; ++row) {
        for (uint32_t column = 0; column < 16; ++column) {
            const Rgb there = map.radiance(map_direction(16, 8, column + 0.5, row + 0.5));
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(there[c], map.texels[row * 16 + column][c], 1e-5);
        }
    }
}

TEST(EnvironmentMap, LookupsDoNotJumpAcrossTheSeamAndThePoles) {
    const EnvironmentMap map = noise_map(16, 8);
    const auto jump = [&map](const Direction& a, const Direction& b) {
        const Rgb there = map.radiance(a), here = map.radiance(b);
        double greatest = 0;
        for (size_t c = 0; c < 3; ++c) greatest = std::max<double>(greatest, std::abs(there[c] - here[c]));
        return greatest;
    };
    for (const double height : steps(-89, 90, 3.5))
        EXPECT_LT(jump(direction_at(179.9999, height), direction_at(-179.9999, height)), 1e-4);
    for (const double azimuth : steps(0, 180, 7)) {
        EXPECT_LT(jump(direction_at(azimuth, 89.9999), direction_at(azimuth + 180, 89.9999)), 1e-4);
        EXPECT_LT(jump(direction_at(azimuth, -89.9999), direction_at(azimuth + 180, -89.9999)), 1e-4);
    }
}

TEST(EnvironmentMap, AYawTurnsTheLightClockwise) {
    const EnvironmentMap map = noise_map(32, 16);
    for (const double yaw : {0.3, -2.0, 7.5}) {
        for (const double azimuth : steps(0, 360, 23)) {
            const Direction from = direction_at(azimuth, azimuth / 6 - 20);
            const Rgb turned = map.radiance(turned_clockwise(from, yaw), yaw), still = map.radiance(from);
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(turned[c], still[c], 1e-4);
        }
    }
    const Direction east = turned_clockwise({0, 1, 0}, M_PI / 2);
    EXPECT_NEAR(east[0], 1, 1e-12);
}

TEST(EnvironmentMap, ReductionKeepsTheEnergyWhateverTheSizes) {
    for (const auto& [width, height, to] :
         {std::tuple{64U, 32U, 16U}, std::tuple{50U, 25U, 14U}, std::tuple{101U, 51U, 100U}, std::tuple{9U, 40U, 8U}}) {
        const EnvironmentMap map = noise_map(width, height);
        const EnvironmentMap less = reduced(map, to);
        EXPECT_LE(less.width, to);
        EXPECT_LE(less.height, to / 2);
        ASSERT_EQ(less.texels.size(), size_t{less.width} * less.height);
        expect_near(map_energy(less), map_energy(map), 1e-6);
    }
}

TEST(EnvironmentMap, ReductionOfAUniformMapIsUniform) {
    const EnvironmentMap less = reduced(uniform_map(75, 37, {1, 2, 3}), 16);
    for (const Rgb& texel : less.texels) {
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(texel[c], static_cast<double>(c + 1), 1e-6);
    }
}

TEST(EnvironmentMap, ReductionTakesMeansOfAreas) {
    const EnvironmentMap map = noise_map(8, 4);
    const EnvironmentMap half = reduced(map, 4);
    const double top = map_solid_angle(8, 4, 0), below = map_solid_angle(8, 4, 1);
    const double expected =
        (top * (map.texels[2][1] + map.texels[3][1]) + below * (map.texels[10][1] + map.texels[11][1])) /
        (2 * (top + below));
    EXPECT_NEAR(half.texels[1][1], expected, 1e-6);
}

TEST(EnvironmentMap, SmallMapsAreNotEnlarged) {
    const EnvironmentMap map = noise_map(8, 4);
    EXPECT_EQ(reduced(map, 64).texels, map.texels);
}

}  // namespace
}  // namespace citystream::client
