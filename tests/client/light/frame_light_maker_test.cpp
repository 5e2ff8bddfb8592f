#include "client/light/frame_light_maker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "client/light/sky_model.h"
#include "client/light/sun_position.h"
#include "tests/client/light/made_maps.h"

namespace citystream::client {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

LightMoment moment_of(EnvironmentMap map, double yaw = 0, std::optional<Sun> sun = {}, double plain = 0) {
    return {std::move(map), yaw, sun, plain};
}

/// Radiance times solid angle of all texels, as the light passes add them up.
LightSum whole_energy(const FrameLight& light) {
    LightSum sum{};
    for (const auto& value : light.sky.values) {
        for (size_t c = 0; c < 3; ++c) sum[c] += value[c] * light.sky.unit[c];
    }
    return sum;
}

EnvironmentMap one_sided(double azimuth_degrees) {
    EnvironmentMap map = uniform_map(256, 128, {0.1F, 0.2F, 0.3F});
    add_disc(map, direction_at(azimuth_degrees, 30), 10 * kDegree, {20, 30, 40});
    return map;
}

TEST(FrameLightMaker, AllPartsHoldTheSameSky) {
    const EnvironmentMap map = one_sided(40);
    FrameLightMaker maker(16, {});
    const FrameLight& light = maker.light(moment_of(map));
    EXPECT_EQ(light.texels_across, 16U);
    EXPECT_EQ(light.sky.values.size(), codec::radiance::texel_count(16));
    expect_near(whole_energy(light), map_energy(map), 1e-3);
    expect_near(map_energy(light.background), map_energy(map), 1e-6);
    EXPECT_EQ(light.background.texels, map.texels);
    const LightSum ambient = light.ambient.irradiance({0, 0, 1}, 5),
                   exact = harmonic_light(map).irradiance({0, 0, 1}, 5);
    expect_near(ambient, exact, 1e-3);
    EXPECT_FALSE(light.sun);
}

TEST(FrameLightMaker, AUniformSkyLightsALevelSurfaceWithPi) {
    for (const uint32_t n : {8U, 16U, 32U}) {
        FrameLightMaker maker(n, {});
        const FrameLight& light = maker.light(moment_of(uniform_map(64, 32, {1, 1, 1})));
        const std::vector<Rgb> even(codec::radiance::texel_count(n), Rgb{1, 1, 1});
        EXPECT_NEAR(level_irradiance(even, n)[1], std::numbers::pi, 0.005 * std::numbers::pi);
        EXPECT_NEAR(light.exposure, 1, 0.005);
    }
}

TEST(FrameLightMaker, TheNumberStaysWhereTheSkyDoes) {
    FrameLightMaker maker(8, {});
    const Sun sun{direction_at(10, 40), {5, 5, 4}, kSunRadius}, other{direction_at(20, 40), {1, 1, 1}, kSunRadius};
    const uint64_t first = maker.light(moment_of(one_sided(40), 0, sun)).number;
    EXPECT_GT(first, 0U);
    EXPECT_EQ(maker.light(moment_of(one_sided(40), 0, sun)).number, first);
    const FrameLight& moved = maker.light(moment_of(one_sided(40), 0, other));
    EXPECT_EQ(moved.number, first) << "the sun is apart from the sky";
    EXPECT_EQ(moved.sun->irradiance, other.irradiance);
    EXPECT_EQ(maker.light(moment_of(one_sided(40), 2 * std::numbers::pi)).number, first) << "a full turn";
    EXPECT_EQ(maker.light(moment_of(one_sided(40), 0.1)).number, first + 1);
    EXPECT_EQ(maker.light(moment_of(one_sided(40), 0.1)).number, first + 1);
    EXPECT_EQ(maker.light(moment_of(one_sided(50), 0.1)).number, first + 2);
    EXPECT_EQ(maker.light(moment_of(uniform_map(64, 32, {1, 1, 1}), 0.1)).number, first + 3);
    EXPECT_EQ(maker.light(moment_of(uniform_map(32, 16, {1, 1, 1}), 0.1)).number, first + 4) << "of another size";
}

TEST(FrameLightMaker, BelowASkyOnlyStandsAPlainThatLightsNothing) {
    const ClearSky sky(sun_direction(48, 172, 12), 3);
    const EnvironmentMap map = sky_map(sky, 64);
    FrameLightMaker maker(16, {});
    const FrameLight& light = maker.light(moment_of(map, 0, sky.sun(), 1));
    const uint64_t number = light.number;
    expect_near(whole_energy(light), map_energy(map), 1e-3);
    const std::vector<Rgb> source = source_radiance(map, 16);
    LightSum level = level_irradiance(source, 16);
    for (size_t c = 0; c < 3; ++c) level[c] += sky.sun()->irradiance[c] * sky.sun()->direction[2];
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(light.background.texels.back()[c], 0.2 * level[c] / std::numbers::pi, 1e-4 * level[c]);
        EXPECT_EQ(light.background.texels.front()[c], map.texels.front()[c]);
    }
    EXPECT_EQ(maker.light(moment_of(map, 0, sky.sun(), 1)).number, number);
    EXPECT_EQ(maker.light(moment_of(map, 0, {}, 1)).number, number + 1) << "the plain without the sun";
    EXPECT_EQ(maker.light(moment_of(map)).number, number + 2) << "no plain";
    EXPECT_EQ(light.background.texels.back(), Rgb{});
}

/// Whatever was lit before.
TEST(FrameLightMaker, AMomentsLightDependsOnNothingElse) {
    FrameLightMaker used(8, {});
    used.light(moment_of(one_sided(40)));
    used.light(moment_of(uniform_map(64, 32, {1, 2, 3}), 1));
    used.light(moment_of(one_sided(90), 2));
    FrameLightMaker fresh(8, {});
    const FrameLight& a = used.light(moment_of(one_sided(90), 2.5));
    const FrameLight& b = fresh.light(moment_of(one_sided(90), 2.5));
    EXPECT_EQ(a.sky.values, b.sky.values);
    EXPECT_EQ(a.sky.unit, b.sky.unit);
    EXPECT_EQ(a.background.texels, b.background.texels);
    EXPECT_EQ(a.ambient.coefficients, b.ambient.coefficients);
    EXPECT_EQ(a.exposure, b.exposure);
}

TEST(FrameLightMaker, AMapTurnedByItsYawIsTheMapOfTheTurnedSky) {
    for (const double degrees : {0.0, 90.0, 33.3, -120.0, 725.0}) {
        const EnvironmentMap turned = turned_map(one_sided(40), degrees * kDegree);
        const EnvironmentMap expected = one_sided(40 + degrees);
        expect_near(map_energy(turned), map_energy(one_sided(40)), 1e-5);
        double difference = 0;
        for (size_t i = 0; i < turned.texels.size(); ++i)
            difference = std::max<double>(difference, std::abs(turned.texels[i][1] - expected.texels[i][1]));
        // Between two columns the rim of the disc is a mixture.
        EXPECT_LT(difference, std::fmod(degrees, 90) == 0 ? 1e-3 : 10) << degrees;
        const Direction middle = direction_at(40 + degrees, 30);
        EXPECT_NEAR(turned.radiance(middle)[1], expected.radiance(middle)[1], 1e-3);
    }
    FrameLightMaker maker(16, {}), straight(16, {});
    const FrameLight& turned = maker.light(moment_of(one_sided(40), 50 * kDegree));
    const FrameLight& expected = straight.light(moment_of(one_sided(90)));
    double total = 0, difference = 0;
    for (size_t k = 0; k < turned.sky.values.size(); ++k) {
        const double a = turned.sky.values[k][0] * turned.sky.unit[0];
        const double b = expected.sky.values[k][0] * expected.sky.unit[0];
        total += b;
        difference += std::abs(a - b);
    }
    EXPECT_LT(difference, 0.05 * total);
    for (const Direction& normal : {direction_at(90, 0), direction_at(0, 90), direction_at(200, 20)}) {
        const LightSum a = turned.ambient.irradiance(normal, 3), b = expected.ambient.irradiance(normal, 3);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 0.02 * map_energy(one_sided(40))[c]);
    }
}

TEST(FrameLightMaker, AutomaticExposureMakesWhiteGroundWhiteByDayAndNightDarker) {
    for (const double light : {1.0, 3.0, 100.0, 1e6})
        EXPECT_NEAR(automatic_exposure(light) * light / std::numbers::pi, 1, 1e-12);
    double before = 1;
    for (const double light : {0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
        const double ground = automatic_exposure(light) * light / std::numbers::pi;
        EXPECT_LT(ground, before);
        EXPECT_GT(ground, 0.1);
        before = ground;
    }
    EXPECT_NEAR(before, 0.126, 0.001);
    for (const double light : {0.0, 1e-12, -1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(automatic_exposure(light), automatic_exposure(1e-7));
    EXPECT_TRUE(std::isfinite(automatic_exposure(1e300)) && automatic_exposure(1e300) > 0);
}

TEST(FrameLightMaker, ExposureCountsTheSunByItsHeightAndStopsAreTakenAsTheyAre) {
    const EnvironmentMap sky = uniform_map(64, 32, {1, 1, 1});
    const Sun high{direction_at(0, 90), {10, 10, 10}, kSunRadius}, low{direction_at(0, 30), {10, 10, 10}, kSunRadius},
        below{direction_at(0, -30), {10, 10, 10}, kSunRadius};
    FrameLightMaker automatic(16, {}), fixed(16, -2.0);
    EXPECT_NEAR(automatic.light(moment_of(sky, 0, high)).exposure, std::numbers::pi / (std::numbers::pi + 10), 0.002);
    EXPECT_NEAR(automatic.light(moment_of(sky, 0, low)).exposure, std::numbers::pi / (std::numbers::pi + 5), 0.002);
    EXPECT_NEAR(automatic.light(moment_of(sky, 0, below)).exposure, 1, 0.005);
    for (const Sun& sun : {high, low, below}) EXPECT_EQ(fixed.light(moment_of(sky, 0, sun)).exposure, 0.25F);
}

TEST(FrameLightMaker, NoLightAtAllIsBlackAndFinite) {
    FrameLightMaker maker(8, {});
    const FrameLight& light = maker.light(moment_of(uniform_map(16, 8, {0, 0, 0})));
    EXPECT_TRUE(std::isfinite(light.exposure));
    for (const auto& value : light.sky.values) EXPECT_EQ(value, (std::array<uint32_t, 3>{}));
    for (const double unit : light.sky.unit) EXPECT_TRUE(std::isfinite(unit) && unit > 0);
}

/// Level ground of albedo 0.5 over a summer's day, as the tone curve gets it.
TEST(FrameLightMaker, ADayGetsDarkAndLightAgainWithoutJumps) {
    FrameLightMaker maker(8, {});
    double before = 0, least = 1, most = 0;
    for (int quarter = 0; quarter <= 4 * 24; ++quarter) {
        const ClearSky sky(sun_direction(48, 172, quarter / 4.0), 3);
        const FrameLight& light = maker.light(moment_of(sky_map(sky, 64), 0, sky.sun()));
        LightSum level{};
        for (uint32_t k = 0; k < light.sky.values.size(); ++k) {
            const auto d = codec::radiance::cell_direction(8, k);
            const double up = d[2] / std::hypot(double(d[0]), double(d[1]), double(d[2]));
            for (size_t c = 0; c < 3; ++c) level[c] += std::max(0.0, up) * light.sky.values[k][c] * light.sky.unit[c];
        }
        if (light.sun) {
            for (size_t c = 0; c < 3; ++c) level[c] += light.sun->irradiance[c] * light.sun->direction[2];
        }
        const double ground = 0.5 * luminance(level) / std::numbers::pi * light.exposure;
        EXPECT_TRUE(quarter == 0 || std::abs(ground - before) < 0.12) << quarter / 4.0;
        before = ground;
        least = std::min(least, ground);
        most = std::max(most, ground);
    }
    EXPECT_NEAR(most, 0.5, 0.01);
    EXPECT_GT(least, 0.05);
    EXPECT_LT(least, 0.1);
}

}  // namespace
}  // namespace citystream::client
