#include "client/light/flight_light.h"

#include <gtest/gtest.h>

#include "tests/client/light/image_folder.h"
#include "tests/client/light/made_maps.h"

namespace citystream::client {
namespace {

LightArguments sky_at(double hour) {
    LightArguments arguments;
    arguments.environment = kAnalyticSky;
    arguments.hour = hour;
    return arguments;
}

/// What the light passes add up.
LightSum energy_of(const FrameLight& light) {
    LightSum sum{};
    for (const auto& value : light.sky.values) {
        for (size_t c = 0; c < 3; ++c) sum[c] += value[c] * light.sky.unit[c];
    }
    return sum;
}

TEST(FlightLight, ExposureIsAutoOrANumberOfStops) {
    EXPECT_EQ(parse_exposure("auto").value(), std::nullopt);
    EXPECT_EQ(parse_exposure("").value(), std::nullopt);
    EXPECT_EQ(parse_exposure("-2.5").value(), -2.5);
    EXPECT_EQ(parse_exposure("64").value(), 64.0);
    for (const char* text : {"x", "1x", " ", "nan", "inf", "65", "-64.01", "1e9", "automatic"}) {
        const auto parsed = parse_exposure(text);
        ASSERT_FALSE(parsed) << text;
        EXPECT_NE(parsed.error().text().find("--exposure"), std::string::npos);
    }
}

TEST(FlightLight, ArgumentsThatDoNotGoTogetherAreNamed) {
    EXPECT_TRUE(check_light_arguments({}));
    EXPECT_TRUE(check_light_arguments(sky_at(9)));
    struct Case {
        LightArguments arguments;
        std::string named;
    };
    std::vector<Case> cases(8);
    cases[0] = {sky_at(9), "--environment-path"};
    cases[0].arguments.environment_path = "day.csv";
    cases[1].named = "--environment-rotation";
    cases[1].arguments.rotation_degrees = 10;
    cases[2].named = "--hour";
    cases[2].arguments.hour = 10;
    cases[3] = {sky_at(9), "--hour"};
    cases[3].arguments.environment = "dawn.hdr";
    cases[4].named = "--exposure";
    cases[4].arguments.exposure = "1";
    cases[5].named = "--sun";
    cases[5].arguments.sun = "map";
    cases[6].named = "--environment-rotation";
    cases[6].arguments.environment_path = "day.csv";
    cases[6].arguments.rotation_degrees = 10;
    cases[7] = {sky_at(9), "--exposure"};
    cases[7].arguments.exposure = "bright";
    for (const Case& one : cases) {
        const Status checked = check_light_arguments(one.arguments);
        ASSERT_FALSE(checked) << one.named;
        EXPECT_NE(checked.error().text().find(one.named), std::string::npos) << checked.error().text();
        EXPECT_EQ(checked.error().text().find('\n'), std::string::npos);
    }
}

TEST(FlightLight, WhatOnlyTheAnalyticSkyHasNeedsIt) {
    const auto with = [](LightArguments arguments, std::optional<double> LightArguments::*value) {
        arguments.*value = 5;
        return arguments;
    };
    LightArguments file, path;
    file.environment = "dawn.hdr";
    path.environment_path = "day.csv";
    for (const auto& [value, option] : {std::pair{&LightArguments::latitude_degrees, "--latitude"},
                                        {&LightArguments::day_of_year, "--day"},
                                        {&LightArguments::turbidity, "--turbidity"}}) {
        EXPECT_TRUE(check_light_arguments(with(sky_at(9), value))) << option;
        EXPECT_TRUE(check_light_arguments(with(path, value))) << option;
        for (const LightArguments& arguments : {LightArguments{}, file}) {
            const Status checked = check_light_arguments(with(arguments, value));
            ASSERT_FALSE(checked) << option;
            EXPECT_NE(checked.error().text().find(option), std::string::npos) << checked.error().text();
        }
    }
}

TEST(FlightLight, TheSunStandsWhereLatitudeAndDayPutItAndHazeTakesOfIt) {
    const auto sun_of = [](const LightArguments& arguments) {
        auto light = FlightLight::load(arguments);
        EXPECT_TRUE(light) << light.error().text();
        FlightLighting facts;
        return *light->at(0, facts).sun;
    };
    LightArguments equinox = sky_at(12);
    equinox.latitude_degrees = 0;
    equinox.day_of_year = 80.5;
    EXPECT_GT(sun_of(equinox).direction[2], 0.999) << "in the zenith of the equator";
    LightArguments south = sky_at(12);
    south.latitude_degrees = -60;
    EXPECT_GT(sun_of(south).direction[1], 0.9) << "low in the north in June";
    LightArguments haze = sky_at(12);
    haze.turbidity = 10;
    EXPECT_LT(luminance(sun_of(haze).irradiance), 0.7 * luminance(sun_of(sky_at(12)).irradiance));
}

TEST(FlightLight, IsDescribedInAFewWords) {
    EXPECT_EQ(describe_light(sky_at(18)), "the analytic sky at 18 h, latitude 48, day 172, turbidity 3");
    LightArguments file;
    file.environment = "maps/dawn.hdr";
    file.rotation_degrees = 90;
    file.sun = "map";
    file.exposure = "-2";
    EXPECT_EQ(describe_light(file), "dawn.hdr, turned by 90 degrees, its sun left in the map, exposure -2");
    LightArguments path;
    path.environment_path = "days/day.csv";
    EXPECT_EQ(describe_light(path), "the environments of day.csv");
}

TEST(FlightLight, FormsOfMatricesHaveNames) {
    EXPECT_EQ(matrix_form_named("biclusters"), codec::radiance::MatrixForm::kBiclusters);
    EXPECT_EQ(matrix_form_named("rows"), codec::radiance::MatrixForm::kRows);
    EXPECT_EQ(matrix_form_named("dense"), std::nullopt);
}

TEST(FlightLight, WhatCannotBeReadIsNamed) {
    LightArguments arguments;
    arguments.environment = "/nowhere/dawn.hdr";
    const auto picture = FlightLight::load(arguments);
    ASSERT_FALSE(picture);
    EXPECT_NE(picture.error().text().find("/nowhere/dawn.hdr"), std::string::npos);
    LightArguments path;
    path.environment_path = "/nowhere/day.csv";
    const auto table = FlightLight::load(path);
    ASSERT_FALSE(table);
    EXPECT_NE(table.error().text().find("/nowhere/day.csv"), std::string::npos);
}

TEST(FlightLight, ASteadySkyIsTheSameAtAllTimes) {
    auto light = FlightLight::load(sky_at(10));
    ASSERT_TRUE(light) << light.error().text();
    light->set_texels_across(8);
    FlightLighting facts;
    const FrameLight& lit = light->at(0, facts);
    EXPECT_EQ(lit.texels_across, 8U);
    EXPECT_TRUE(lit.sun);
    EXPECT_EQ(facts.environment, kAnalyticSky);
    EXPECT_EQ(facts.hour, 10);
    EXPECT_EQ(facts.share, 1);
    EXPECT_EQ(facts.rotation_degrees, 0);
    EXPECT_EQ(facts.exposure, double{lit.exposure});
    const uint64_t number = facts.number;
    EXPECT_EQ(number, lit.number);
    EXPECT_EQ(light->at(100, facts).number, number);
}

TEST(FlightLight, NoonWhereNoHourIsSaidAndTheSunStaysInTheMapWhereWanted) {
    LightArguments arguments;
    arguments.environment = kAnalyticSky;
    auto apart = FlightLight::load(arguments);
    arguments.sun = "map";
    auto inside = FlightLight::load(arguments);
    ASSERT_TRUE(apart && inside);
    FlightLighting facts;
    const FrameLight& split = apart->at(0, facts);
    EXPECT_EQ(facts.hour, 12);
    ASSERT_TRUE(split.sun);
    const FrameLight& whole = inside->at(0, facts);
    EXPECT_FALSE(whole.sun);
    const LightSum all = energy_of(whole), sky = energy_of(split);
    LightSum both = sky;
    for (size_t c = 0; c < 3; ++c) both[c] += split.sun->irradiance[c];
    expect_near(all, both, 2e-3);
    EXPECT_GT(all[1], 2 * sky[1]);
}

TEST(FlightLight, AlongAPathTheFactsAreThoseOfTheGreaterShare) {
    const LightFolder folder;
    const EnvironmentMap map = uniform_map(64, 32, {1, 1, 1});
    folder.write("even.exr", map.width, map.height, map.texels);
    LightArguments arguments;
    arguments.environment_path = folder.write_bytes(
        "day.csv",
        "time_s,environment,rotation_degrees,hour\n0,even.exr,0,\n10,even.exr,90,\n20,sky,90,9\n30,sky,90,10\n");
    arguments.exposure = "1";
    auto light = FlightLight::load(arguments);
    ASSERT_TRUE(light) << light.error().text();
    FlightLighting at5, at12, at18, at25;
    EXPECT_EQ(light->at(5, at5).exposure, 2);
    light->at(12, at12);
    light->at(18, at18);
    light->at(25, at25);
    EXPECT_TRUE(at5.environment.ends_with("even.exr"));
    EXPECT_EQ(at5.rotation_degrees, 45);
    EXPECT_EQ(at5.hour, 0);
    EXPECT_TRUE(at12.environment.ends_with("even.exr"));
    EXPECT_NEAR(at12.share, 0.8, 1e-12);
    EXPECT_EQ(at18.environment, kAnalyticSky);
    EXPECT_NEAR(at18.share, 0.8, 1e-12);
    EXPECT_EQ(at18.hour, 9);
    EXPECT_EQ(at25.hour, 9.5);
    EXPECT_GT(at25.number, at18.number);
}

}  // namespace
}  // namespace citystream::client
