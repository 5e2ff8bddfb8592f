#include "client/light/environment_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/light/sky_model.h"
#include "client/light/sun_position.h"
#include "tests/client/light/image_folder.h"
#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

constexpr double kDegree = M_PI / 180;

EnvironmentPath path_of(const std::string& rows) {
    const std::string text = "time_s,environment,rotation_degrees,hour\n" + rows;
    return parse_environment_path(std::span(text.data(), text.size())).value();
}

EnvironmentMap sunny(const Direction& towards, float radiance, uint32_t width = 512) {
    EnvironmentMap map = uniform_map(width, width / 2, {1, 1, 2});
    add_disc(map, towards, kSunRadius, {radiance, radiance, radiance});
    return map;
}

LightSum energy_of(const LightMoment& moment) {
    LightSum energy = map_energy(moment.map);
    for (size_t c = 0; c < 3; ++c) energy[c] += moment.sun ? moment.sun->irradiance[c] : 0;
    return energy;
}

struct TwoFiles {
    LightFolder folder;
    EnvironmentMap a = sunny(direction_at(20, 50), 3e4F), b = sunny(direction_at(200, 30), 6e4F, 256);
    std::string name_a = folder.write("a.exr", a.width, a.height, a.texels);
    std::string name_b = folder.write("b.exr", b.width, b.height, b.texels);
};

TEST(EnvironmentLight, APictureTurnsWithItsSun) {
    const TwoFiles files;
    const auto light = EnvironmentLight::load(path_of("0," + files.name_a + ",0,\n10," + files.name_a + ",90,\n"), {});
    ASSERT_TRUE(light) << light.error().text();
    EXPECT_TRUE(light->warnings().empty());
    for (const double t : {0.0, 4.0, 10.0}) {
        const LightMoment moment = light->at(t);
        ASSERT_TRUE(moment.sun);
        EXPECT_NEAR(moment.yaw, 9 * t * kDegree, 1e-12);
        EXPECT_LT(angle_between(moment.sun->direction, direction_at(20 + 9 * t, 50)), 0.2 * kDegree);
        expect_near(energy_of(moment), map_energy(files.a), 1e-4);
    }
}

TEST(EnvironmentLight, MapsAreKeptNoWiderThanAskedFor) {
    const TwoFiles files;
    LightSettings settings;
    settings.map_width = 128;
    const auto light = EnvironmentLight::load(steady_environment(files.name_a, 0, 0), settings);
    ASSERT_TRUE(light);
    EXPECT_EQ(light->at(0).map.width, 128u);
    EXPECT_EQ(light->at(0).map.height, 64u);
    expect_near(energy_of(light->at(0)), map_energy(files.a), 1e-4);
}

TEST(EnvironmentLight, FadingLosesNoLightAndShowsTheBrighterSun) {
    const TwoFiles files;
    const auto light = EnvironmentLight::load(path_of("0," + files.name_a + ",0,\n10," + files.name_b + ",0,\n"), {});
    ASSERT_TRUE(light) << light.error().text();
    const LightSum a = map_energy(files.a), b = map_energy(files.b);
    for (const double t : steps(0, 10, 1.25)) {
        const LightMoment moment = light->at(t);
        LightSum expected{};
        for (size_t c = 0; c < 3; ++c) expected[c] = a[c] + (b[c] - a[c]) * t / 10;
        expect_near(energy_of(moment), expected, 1e-4);
        ASSERT_TRUE(moment.sun);
        // 6e4 s > 3e4 (1 - s) from s = 1/3.
        EXPECT_LT(angle_between(moment.sun->direction, t < 10.0 / 3 ? direction_at(20, 50) : direction_at(200, 30)),
                  1 * kDegree)
            << t;
    }
}

TEST(EnvironmentLight, ADayOfTheAnalyticSky) {
    LightSettings settings;
    settings.latitude_degrees = 35.7;
    settings.day_of_year = 80;
    const auto light = EnvironmentLight::load(path_of("0,sky,0,0\n24,sky,0,24\n"), settings);
    ASSERT_TRUE(light);
    for (const double t : steps(0, 24, 1.5)) {
        const LightMoment moment = light->at(t);
        const Direction towards = sun_direction(35.7, 80, t);
        EXPECT_EQ(moment.sun.has_value(), towards[2] > -kSunRadius) << t;
        if (moment.sun) {
            EXPECT_LT(angle_between(moment.sun->direction, towards), 1e-9);
        }
        for (const Rgb& texel : moment.map.texels) {
            for (const float v : texel) ASSERT_TRUE(v >= 0 && std::isfinite(v));
        }
    }
    EXPECT_GT(luminance(energy_of(light->at(12))), 1e5 * luminance(energy_of(light->at(0))));
}

TEST(EnvironmentLight, ThePictureOfASkyFadesIntoTheAnalyticOne) {
    const TwoFiles files;
    const auto light = EnvironmentLight::load(path_of("0," + files.name_a + ",0,\n10,sky,0,12\n"), {});
    ASSERT_TRUE(light);
    const LightMoment first = light->at(0), last = light->at(10), middle = light->at(5);
    EXPECT_EQ(middle.map.width, files.a.width);
    const LightSum a = energy_of(first), b = energy_of(last);
    expect_near(energy_of(middle), {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}, 0.01);
}

TEST(EnvironmentLight, APlainFadesWithTheSkyThatHasNothingBelowItsHorizon) {
    const TwoFiles files;
    EnvironmentMap dome = files.a;
    std::fill(dome.texels.begin() + static_cast<ptrdiff_t>(dome.texels.size() / 2), dome.texels.end(), Rgb{});
    const std::string name = files.folder.write("dome.exr", dome.width, dome.height, dome.texels);
    const auto light = EnvironmentLight::load(
        path_of("0," + files.name_a + ",0,\n10,sky,0,12\n20," + name + ",0,\n30," + files.name_b + ",0,\n"), {});
    ASSERT_TRUE(light) << light.error().text();
    for (const auto& [t, plain] :
         {std::pair{0.0, 0.0}, {2.5, 0.25}, {10.0, 1.0}, {15.0, 1.0}, {24.0, 0.6}, {30.0, 0.0}})
        EXPECT_NEAR(light->at(t).plain, plain, 1e-12) << t;
}

TEST(EnvironmentLight, SunsMayStayInTheMaps) {
    const TwoFiles files;
    LightSettings settings;
    settings.take_suns = false;
    const auto light = EnvironmentLight::load(path_of("0," + files.name_a + ",0,\n10,sky,0,12\n"), settings);
    ASSERT_TRUE(light);
    const auto split = EnvironmentLight::load(path_of("0," + files.name_a + ",0,\n10,sky,0,12\n"), {});
    ASSERT_TRUE(split);
    for (const double t : {0.0, 5.0, 10.0}) {
        EXPECT_FALSE(light->at(t).sun);
        expect_near(energy_of(light->at(t)), energy_of(split->at(t)), 1e-3);
    }
}

TEST(EnvironmentLight, SaysWhatCannotBeReadAndWhatWasMended) {
    const TwoFiles files;
    const std::string missing = files.folder.path("missing.hdr");
    EXPECT_EQ(EnvironmentLight::load(path_of("0,sky,0,0\n1," + missing + ",0,\n"), {}).error().text(),
              "cannot read environment map " + missing + ": there is no such file");
    std::vector<Rgb> texels(size_t{16} * 8, Rgb{1, 1, 1});
    texels[9][1] = -1;
    const std::string bad = files.folder.write("bad.exr", 16, 8, texels);
    const auto light = EnvironmentLight::load(steady_environment(bad, 0, 0), {});
    ASSERT_TRUE(light);
    EXPECT_EQ(light->warnings(), (std::vector<std::string>{bad + ": 1 texel mended: 1 negative"}));
}

}  // namespace
}  // namespace citystream::client
