#include "client/light/source_cube.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "client/light/environment_file.h"
#include "codec/radiance/source_directions.h"
#include "codec/radiance/source_light.h"
#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

using codec::radiance::cell_direction;
using codec::radiance::cell_of;
using codec::radiance::cell_solid_angle;
using codec::radiance::texel_count;

Direction texel_direction(uint32_t side, uint32_t texel) {
    const auto d = cell_direction(side, texel);
    const double length = std::sqrt(double(d[0]) * d[0] + double(d[1]) * d[1] + double(d[2]) * d[2]);
    return {d[0] / length, d[1] / length, d[2] / length};
}

double irradiance(std::span<const Rgb> radiance, uint32_t side, const Direction& normal, size_t channel) {
    double sum = 0;
    for (uint32_t k = 0; k < radiance.size(); ++k) {
        sum += radiance[k][channel] * cell_solid_angle(side, k) * std::max(dot(texel_direction(side, k), normal), 0.0);
    }
    return sum;
}

TEST(SourceCube, AUniformSkyIsUniformAndGivesPiOnEveryNormal) {
    for (const auto& [width, side] : {std::pair{2U, 4U}, std::pair{16U, 16U}, std::pair{1024U, 32U}}) {
        const std::vector<Rgb> cube = source_radiance(uniform_map(width, width / 2, {0.25F, 1, 8}), side, 0.7);
        ASSERT_EQ(cube.size(), texel_count(side));
        for (const Rgb& texel : cube) {
            EXPECT_NEAR(texel[0], 0.25, 1e-6);
            EXPECT_NEAR(texel[1], 1, 2e-6);
            EXPECT_NEAR(texel[2], 8, 2e-5);
        }
    }
    const std::vector<Rgb> cube = source_radiance(uniform_map(64, 32, {1, 1, 1}), 32);
    for (const double azimuth : steps(0, 360, 41)) {
        for (const double height : steps(-90, 90, 22.5))
            EXPECT_NEAR(irradiance(cube, 32, direction_at(azimuth, height), 1), std::numbers::pi,
                        0.002 * std::numbers::pi);
    }
}

TEST(SourceCube, EachTexelHasTheLightOfItsDirection) {
    // Smooth, and different on every axis.
    const auto light = [](const Direction& d) {
        return Rgb{static_cast<float>(2 + d[0]), static_cast<float>(2 + d[1]), static_cast<float>(2 + d[2])};
    };
    const std::vector<Rgb> cube = source_radiance(made_map(512, 256, light), 16);
    for (uint32_t k = 0; k < cube.size(); ++k) {
        const Rgb expected = light(texel_direction(16, k));
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(cube[k][c], expected[c], 0.01) << k;
    }
}

TEST(SourceCube, KeepsTheEnergyOfMadeUpMaps) {
    std::vector<EnvironmentMap> maps = {noise_map(1024, 512), noise_map(64, 32), noise_map(8, 4), noise_map(99, 51)};
    maps.push_back(noise_map(256, 128));
    add_disc(maps.back(), direction_at(100, 30), 0.01, {1e6F, 1e5F, 1e4F});
    maps.push_back(uniform_map(32, 16, {0, 0, 0}));
    maps.back().texels[77] = {1e6F, 1, 1e-6F};
    for (const EnvironmentMap& map : maps) {
        for (const uint32_t side : {1U, 12U, 32U}) {
            const std::vector<Rgb> cube = source_radiance(map, side, 0.4);
            expect_near(source_energy(cube, side), map_energy(map), 1e-5);
        }
    }
}

TEST(SourceCube, KeepsTheEnergyOfRealMaps) {
    const std::vector<std::string> files = shared_environments();
    if (files.empty()) GTEST_SKIP() << "../shared/data/hdr_env is absent";
    for (const std::string& file : files) {
        const auto environment = read_environment(file);
        ASSERT_TRUE(environment) << environment.error().text();
        const std::vector<Rgb> cube = source_radiance(environment->map, 32, 1);
        expect_near(source_energy(cube, 32), map_energy(environment->map), 1e-5);
    }
}

TEST(SourceCube, ALampOfOneTexelStaysWhereItIsAndTakesNothingFromTheSky) {
    EnvironmentMap map = uniform_map(512, 256, {1, 1, 1});
    const size_t lamp = size_t{77} * 512 + 300;
    map.texels[lamp] = {1e6F, 1e6F, 1e6F};
    const Direction towards = map_direction(512, 256, 300.5, 77.5);
    const std::vector<Rgb> cube = source_radiance(map, 32);
    double near_it = 0;
    for (uint32_t k = 0; k < cube.size(); ++k) {
        for (const float v : cube[k]) EXPECT_GE(v, 0.9999F);
        if (angle_between(texel_direction(32, k), towards) < 0.08)
            near_it += (cube[k][0] - 1) * cell_solid_angle(32, k);
        else
            EXPECT_NEAR(cube[k][0], 1, 1e-4) << k;
    }
    EXPECT_NEAR(near_it, (1e6 - 1) * map_solid_angle(512, 256, 77), 1e-3 * near_it);
    EXPECT_GT(cube[cell_of(towards, 32)][0], 100);
}

TEST(SourceCube, AYawIsTheMapTurned) {
    const EnvironmentMap map = noise_map(256, 128);
    // A quarter turn clockwise moves the picture by a quarter of its width to the right.
    EnvironmentMap moved = map;
    for (size_t i = 0; i < map.texels.size(); ++i) moved.texels[i / 256 * 256 + (i % 256 + 64) % 256] = map.texels[i];
    const std::vector<Rgb> turned = source_radiance(map, 16, std::numbers::pi / 2),
                           expected = source_radiance(moved, 16);
    const std::vector<Rgb> still = source_radiance(map, 16);
    double difference = 0, most = 0;
    for (size_t k = 0; k < turned.size(); ++k) {
        for (size_t c = 0; c < 3; ++c) {
            most = std::max<double>(most, std::abs(turned[k][c] - expected[k][c]));
            difference += std::abs(turned[k][c] - still[k][c]);
        }
    }
    EXPECT_LT(most, 0.01);
    EXPECT_GT(difference / static_cast<double>(3 * turned.size()), 0.01);
}

TEST(SourceCube, ATurnedMapIsWhatALookupThatIsTurnedBackSees) {
    const auto light = [](const Direction& d) {
        return Rgb{static_cast<float>(2 + d[0] * d[2]), static_cast<float>(2 + d[1]),
                   static_cast<float>(2 + d[0] * d[1])};
    };
    const EnvironmentMap map = made_map(256, 128, light);
    for (const double yaw : {0.2, 1.9, -3.0}) {
        const std::vector<Rgb> cube = source_radiance(map, 16, yaw);
        for (uint32_t k = 0; k < cube.size(); ++k) {
            const Rgb there = map.radiance(texel_direction(16, k), yaw);
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(cube[k][c], there[c], 0.02);
        }
    }
}

TEST(SourceCube, ASamplerTurnsMapsOfItsSizeAsOneCallEachDoes) {
    const SourceSampler sampler(128, 64, 8);
    for (const uint32_t seed : {1U, 2U}) {
        const EnvironmentMap map = noise_map(128, 64, seed);
        for (const double yaw : {-7.0, -0.1, 0.0, 0.4, 3.2, 6.3, 100.0})
            EXPECT_EQ(sampler.radiance(map, yaw), source_radiance(map, 8, yaw)) << yaw;
    }
}

TEST(SourceCube, TheYawOfATilesAxesAddsToTheMaps) {
    // codec::radiance::turned_light: what a tile sees whose axes are turned counter-clockwise.
    const EnvironmentMap map = made_map(256, 128, [](const Direction& d) {
        return Rgb{static_cast<float>(2 + d[0] * d[2]), static_cast<float>(2 + d[1]), static_cast<float>(2 + d[0])};
    });
    const std::vector<Rgb> still = source_radiance(map, 16, 0.4);
    const std::vector<Rgb> turned = codec::radiance::turned_light(still, 16, 1.1);
    const std::vector<Rgb> expected = source_radiance(map, 16, 1.5);
    for (size_t k = 0; k < turned.size(); ++k) {
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(turned[k][c], expected[k][c], 0.05);
    }
}

TEST(SourceCube, WholeTurnsChangeNothing) {
    const EnvironmentMap map = noise_map(64, 32);
    const std::vector<Rgb> once = source_radiance(map, 8, 1), again = source_radiance(map, 8, 1 + 6 * std::numbers::pi);
    for (size_t k = 0; k < once.size(); ++k) {
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(once[k][c], again[k][c], 0.02);
    }
}

TEST(SourceCube, IsTheSameEveryTime) {
    const EnvironmentMap map = noise_map(300, 150);
    EXPECT_EQ(source_radiance(map, 12, 0.1), source_radiance(map, 12, 0.1));
}

}  // namespace
}  // namespace citystream::client
