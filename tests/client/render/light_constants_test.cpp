#include "client/render/light_constants.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::client {
namespace {

FrameLight light_with(HarmonicLight ambient) {
    FrameLight light;
    light.ambient = ambient;
    light.background = {1, 1, {{0, 0, 0}}};
    return light;
}

TEST(LightConstants, AmbientTermsAreTheHarmonicsOfTheFirstThreeBands) {
    HarmonicLight ambient;
    for (size_t i = 0; i < 9; ++i) {
        for (size_t c = 0; c < 3; ++c)
            ambient.coefficients[i][c] = i == 0 ? 20.0 : 0.3 + 0.2 * static_cast<double>((7 * i + 3 * c) % 5);
    }
    FrameLight light = light_with(ambient);
    light.exposure = 1.5F;
    const LightConstants constants = light_constants(light, {1, 1, 1}, 1);
    for (const Direction& n : {Direction{0, 0, 1}, Direction{0, 0, -1}, Direction{1, 0, 0}, Direction{0, -1, 0},
                               Direction{0.6, 0, 0.8}, Direction{0.48, -0.64, 0.6}, Direction{-0.36, 0.48, -0.8}}) {
        const LightSum expected = ambient.irradiance(n, 3);
        const auto got = open_sky_light(constants, n);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], 1.5 / std::acos(-1.0) * expected[c], 1e-5);
    }
}

TEST(LightConstants, AmbientLightIsNeverNegative) {
    HarmonicLight ambient;
    add_parallel_light(ambient, {0, 0, 1}, {1, 1, 1});
    const LightConstants constants = light_constants(light_with(ambient), {1, 1, 1}, 1);
    EXPECT_LT(ambient.irradiance({std::sqrt(0.75), 0, -0.5}, 3)[0], 0);
    EXPECT_EQ(open_sky_light(constants, {std::sqrt(0.75), 0, -0.5})[0], 0);
}

TEST(LightConstants, TheDiscGivesTheSunsLight) {
    FrameLight light = light_with({});
    light.sun = Sun{{0, 0, 1}, {2, 1, 0.5}, 0.1};
    const LightConstants constants = light_constants(light, {1, 1, 1}, 1);
    // Area of a disc of that chord on the unit sphere.
    const double area = std::acos(-1.0) * static_cast<double>(constants.disc_radius * constants.disc_radius);
    EXPECT_NEAR(static_cast<double>(constants.disc[0]) * area, 2, 1e-3);
    EXPECT_NEAR(static_cast<double>(constants.sun[1]), 1 / std::acos(-1.0), 1e-6);
}

TEST(LightConstants, ASunBelowTheHorizonIsSeenAndLightsNothing) {
    FrameLight light = light_with({});
    for (const Direction& towards : {Direction{0.8, 0, -0.6}, Direction{1, 0, 0}}) {
        light.sun = Sun{towards, {2, 1, 0.5}, 0.1};
        const LightConstants constants = light_constants(light, {1, 1, 1}, 1);
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(constants.sun[c], 0);
            EXPECT_GT(constants.disc[c], 0);
        }
    }
}

}  // namespace
}  // namespace citystream::client
