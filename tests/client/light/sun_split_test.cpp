#include "client/light/sun_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "client/light/environment_file.h"
#include "client/light/sky_model.h"
#include "tests/client/light/made_maps.h"

namespace citystream::client {
namespace {

constexpr double kDegree = M_PI / 180;

/// Brighter towards the horizon and one side, as skies are.
EnvironmentMap graded_sky(uint32_t width) {
    return made_map(width, width / 2, [](const Direction& d) {
        const double light = 1 + 0.6 * d[0] + 0.8 * (1 - std::abs(d[2]));
        return Rgb{static_cast<float>(0.5 * light), static_cast<float>(0.7 * light), static_cast<float>(light)};
    });
}

LightSum sum_of(const LightSum& a, const LightSum& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

TEST(SunSplit, FindsTheDirectionAndTheIrradianceOfASun) {
    const Rgb radiance = {5e4F, 4e4F, 3e4F};
    for (const uint32_t width : {1024U, 2048U}) {
        const EnvironmentMap sky = graded_sky(width);
        for (const auto& [azimuth, height] : {std::pair{133.3, 41.7}, std::pair{179.95, 12.0}, std::pair{-71.0, 0.5},
                                              std::pair{20.0, 89.8}, std::pair{-20.0, 75.0}}) {
            EnvironmentMap map = sky;
            const Direction towards = direction_at(azimuth, height);
            add_disc(map, towards, kSunRadius, radiance);
            const LightSum before = map_energy(map);
            const std::optional<Sun> sun = take_sun(map);
            ASSERT_TRUE(sun) << width << " " << azimuth << " " << height;
            EXPECT_LT(angle_between(sun->direction, towards), 0.1 * kDegree)
                << width << " " << azimuth << " " << height;
            const double solid_angle = disc_solid_angle(kSunRadius);
            expect_near(sun->irradiance, {5e4 * solid_angle, 4e4 * solid_angle, 3e4 * solid_angle}, 0.01);
            EXPECT_NEAR(sun->angular_radius, kSunRadius, 0.15 * kDegree);
            expect_near(sum_of(map_energy(map), sun->irradiance), before, 1e-6);
            for (size_t i = 0; i < map.texels.size(); ++i) {
                for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(map.texels[i][c], sky.texels[i][c], 0.1) << i;
            }
        }
    }
}

TEST(SunSplit, FindsTheSizeOfALargeSun) {
    EnvironmentMap map = graded_sky(1024);
    add_disc(map, direction_at(50, 30), 2 * kDegree, {1e3F, 1e3F, 1e3F});
    const std::optional<Sun> sun = take_sun(map);
    ASSERT_TRUE(sun);
    EXPECT_NEAR(sun->angular_radius, 2 * kDegree, 0.1 * kDegree);
}

TEST(SunSplit, MapsWithoutASunStayAsTheyAre) {
    std::vector<EnvironmentMap> maps = {
        graded_sky(512),     uniform_map(256, 128, {1, 1, 1}), uniform_map(64, 32, {0, 0, 0}),
        noise_map(256, 128), uniform_map(2, 1, {3, 3, 3}),     uniform_map(1, 1, {3, 3, 3})};
    // A bright window is no sun, however bright, nor is a hot pixel that lights nothing.
    maps.push_back(graded_sky(512));
    add_disc(maps.back(), direction_at(10, 20), 12 * kDegree, {1e4F, 1e4F, 1e4F});
    maps.push_back(graded_sky(1024));
    maps.back().texels[200000] = {200, 200, 200};
    for (EnvironmentMap& map : maps) {
        const EnvironmentMap before = map;
        EXPECT_FALSE(take_sun(map));
        EXPECT_EQ(map.texels, before.texels);
    }
}

TEST(SunSplit, OfSeveralLampsItTakesTheBrightest) {
    EnvironmentMap map = uniform_map(1024, 512, {0.01F, 0.01F, 0.01F});
    const Direction bright = direction_at(100, 40);
    add_disc(map, direction_at(-100, 50), 0.02, {100, 100, 100});
    add_disc(map, bright, 0.02, {300, 300, 300});
    add_disc(map, direction_at(0, 20), 0.02, {200, 200, 200});
    const LightSum before = map_energy(map);
    const std::optional<Sun> sun = take_sun(map);
    ASSERT_TRUE(sun);
    EXPECT_LT(angle_between(sun->direction, bright), 0.1 * kDegree);
    EXPECT_NEAR(sun->irradiance[1], 300 * disc_solid_angle(0.02), 0.01 * 300 * disc_solid_angle(0.02));
    expect_near(sum_of(map_energy(map), sun->irradiance), before, 1e-6);
    EXPECT_GT(luminance(map.radiance(direction_at(0, 20))), 150);
}

TEST(SunSplit, WhatShinesFromBelowTheHorizonStaysInTheMap) {
    EnvironmentMap lamp = uniform_map(512, 256, {0.01F, 0.01F, 0.01F});
    add_disc(lamp, direction_at(30, -20), 0.02, {1000, 1000, 1000});
    add_disc(lamp, direction_at(-80, -0.5), 0.02, {500, 500, 500});
    const EnvironmentMap before = lamp;
    EXPECT_FALSE(take_sun(lamp));
    EXPECT_EQ(lamp.texels, before.texels);
    // The sun over water is taken, though its mirror image be the brighter one.
    EnvironmentMap sea = uniform_map(512, 256, {0.01F, 0.01F, 0.01F});
    add_disc(sea, direction_at(30, -20), 0.02, {1000, 1000, 1000});
    add_disc(sea, direction_at(30, 20), 0.02, {300, 300, 300});
    const std::optional<Sun> sun = take_sun(sea);
    ASSERT_TRUE(sun);
    EXPECT_LT(angle_between(sun->direction, direction_at(30, 20)), 0.1 * kDegree);
    EXPECT_GT(luminance(sea.radiance(direction_at(30, -20))), 900);
}

TEST(SunSplit, TakesADeltaLightAMillionTimesTheSkyWhole) {
    EnvironmentMap map = uniform_map(512, 256, {1, 1, 1});
    map.texels[size_t{60} * 512 + 511] = {1e6F, 1e6F, 1e6F};
    const std::optional<Sun> sun = take_sun(map);
    ASSERT_TRUE(sun);
    EXPECT_NEAR(sun->irradiance[0], (1e6 - 1) * map_solid_angle(512, 256, 60), 1);
    for (const Rgb& texel : map.texels) {
        for (const float v : texel) EXPECT_NEAR(v, 1, 1e-5);
    }
}

TEST(SunSplit, SplitsRealMapsWithoutLosingLight) {
    const std::vector<std::string> files = shared_environments();
    if (files.empty()) GTEST_SKIP() << "../shared/data/hdr_env is absent";
    for (const std::string& file : files) {
        auto environment = read_environment(file);
        ASSERT_TRUE(environment) << environment.error().text();
        const LightSum before = map_energy(environment->map);
        const std::optional<Sun> sun = take_sun(environment->map);
        const LightSum after = map_energy(environment->map);
        expect_near(sun ? sum_of(after, sun->irradiance) : after, before, 1e-6);
        for (const Rgb& texel : environment->map.texels) {
            for (const float v : texel) ASSERT_GE(v, 0);
        }
    }
}

TEST(SunSplit, FindsTheSunsOfRealSkiesAndNoneUnderCloudsOrIndoors) {
    const std::vector<std::string> files = shared_environments();
    if (files.empty()) GTEST_SKIP() << "../shared/data/hdr_env is absent";
    const auto sun_height = [&files](const std::string& name) -> std::optional<double> {
        const auto file = std::find_if(files.begin(), files.end(),
                                       [&](const std::string& f) { return f.find(name) != std::string::npos; });
        if (file == files.end()) return std::nullopt;
        auto environment = read_environment(*file);
        if (!environment) return std::nullopt;
        const std::optional<Sun> sun = take_sun(environment->map);
        if (!sun) return std::nullopt;
        return std::asin(sun->direction[2]) / kDegree;
    };
    // Where their brightest texels are.
    EXPECT_NEAR(sun_height("immenstadter_horn").value_or(0), 35.5, 0.5);
    EXPECT_NEAR(sun_height("venice_sunset").value_or(0), 3.4, 0.5);
    for (const char* name : {"potsdamer_platz", "kiara_1_dawn", "lebombo", "empty_warehouse"})
        EXPECT_FALSE(sun_height(name)) << name;
}

}  // namespace
}  // namespace citystream::client
