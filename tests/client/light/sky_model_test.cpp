#include "client/light/sky_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/light/sun_position.h"
#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

/// On level ground, sky only.
LightSum sky_irradiance(const ClearSky& sky, uint32_t height = 64) {
    LightSum sum{};
    for (uint32_t row = 0; row < height / 2; ++row) {
        for (uint32_t column = 0; column < 2 * height; ++column) {
            const Direction from = map_direction(2 * height, height, column + 0.5, row + 0.5);
            const LightSum light = sky.radiance(from);
            for (size_t c = 0; c < 3; ++c) sum[c] += map_solid_angle(2 * height, height, row) * from[2] * light[c];
        }
    }
    return sum;
}

double level_illuminance(double sun_height, double turbidity, uint32_t height = 64) {
    const ClearSky sky(direction_at(150, sun_height), turbidity);
    const auto sun = sky.sun();
    return luminance(sky_irradiance(sky, height)) +
           (sun ? luminance(sun->irradiance) * std::max(sun->direction[2], 0.0) : 0.0);
}

TEST(SkyModel, IlluminanceIsThatOfTheTables) {
    // Janiczek and DeYoung: log10 of lux.
    EXPECT_NEAR(std::log10(1000 * clear_illuminance(90)), 5.11, 0.005);
    EXPECT_NEAR(std::log10(1000 * clear_illuminance(0)), 2.88, 0.005);
    EXPECT_NEAR(1000 * clear_illuminance(-6), 3.4, 0.1);        // end of the civil dusk
    EXPECT_NEAR(1000 * clear_illuminance(-12), 0.008, 0.0005);  // of the nautical
    EXPECT_NEAR(1000 * clear_illuminance(-18), 6.6e-4, 2e-5);   // of the astronomical
    EXPECT_EQ(clear_illuminance(-50), clear_illuminance(-18));
    for (const double height : steps(-18, 90, 0.01))
        EXPECT_GT(clear_illuminance(height + 0.01), 0.98 * clear_illuminance(height)) << height;
}

TEST(SkyModel, AirMassIsKastenAndYoungs) {
    EXPECT_NEAR(air_mass(90), 1, 0.001);
    EXPECT_NEAR(air_mass(30), 1.994, 0.001);
    EXPECT_NEAR(air_mass(10), 5.586, 0.01);
    EXPECT_NEAR(air_mass(0), 37.92, 0.01);
}

TEST(SkyModel, LuminanceIsSpreadAsPreethamHasIt) {
    // Turbidity 3, sun 40 degrees from the zenith; F of appendix A.2 at 60 degrees from the zenith, 20 from the sun.
    const double a = 0.1787 * 3 - 1.4630, b = -0.3554 * 3 + 0.4275, c = -0.0227 * 3 + 5.3251, d = 0.1206 * 3 - 2.5771,
                 e = -0.0670 * 3 + 0.3703;
    const auto perez = [&](double theta, double gamma) {
        return (1 + a * std::exp(b / std::cos(theta))) *
               (1 + c * std::exp(d * gamma) + e * std::cos(gamma) * std::cos(gamma));
    };
    const double degree = M_PI / 180;
    const ClearSky sky(direction_at(90, 50), 3);
    EXPECT_NEAR(luminance(sky.radiance(direction_at(90, 30))) / luminance(sky.radiance({0, 0, 1})),
                perez(60 * degree, 20 * degree) / perez(0, 40 * degree), 1e-9);
}

TEST(SkyModel, SkyAndSunTogetherHaveTheIlluminanceOfTheTables) {
    for (const double turbidity : {2.0, 3.0, 6.0}) {
        for (const double height : steps(0.5, 90, 7.4)) {
            EXPECT_NEAR(level_illuminance(height, turbidity), clear_illuminance(height),
                        0.05 * clear_illuminance(height))
                << height << " " << turbidity;
        }
    }
}

TEST(SkyModel, TheDaySkyIsNearAnIndependentFormula) {
    // Clear sky without the sun, klx: 0.8 + 15.5 sqrt(sin(height)) (IES Lighting Handbook, 1984).
    for (const double height : steps(10, 30, 5)) {
        const double expected = 0.8 + 15.5 * std::sqrt(std::sin(height * M_PI / 180));
        EXPECT_NEAR(luminance(sky_irradiance(ClearSky(direction_at(0, height), 3))), expected, 0.1 * expected)
            << height;
    }
}

TEST(SkyModel, DuskAndNightHaveTheIlluminanceOfTheTables) {
    for (const double height : {0.0, -1.0, -3.0, -6.0, -9.0, -12.0, -17.0, -18.0, -40.0, -90.0}) {
        const ClearSky sky(direction_at(260, height), 3);
        EXPECT_NEAR(luminance(sky_irradiance(sky)), clear_illuminance(height), 0.02 * clear_illuminance(height))
            << height;
    }
}

TEST(SkyModel, LightNeverJumpsThroughTheDay) {
    // It changes by a factor of 1.15 in an eighth of a degree in the nautical dusk.
    double before = level_illuminance(-20, 4, 16);
    const auto climb = [&before](double from, double to, double step, double most) {
        for (const double height : steps(from, to, step)) {
            const double now = level_illuminance(height, 4, 16);
            EXPECT_LT(std::abs(now - before), most * std::max(now, before)) << height;
            before = now;
        }
    };
    climb(-20, 1, 0.02, 0.03);
    climb(1, 90, 0.2, 0.1);
}

TEST(SkyModel, RadianceIsNeverNegativeNorInfinite) {
    for (const double turbidity : {-1.0, 2.0, 5.0, 10.0, 1e9}) {
        for (const double sun_height : {-90.0, -18.5, -4.0, -0.1, 0.0, 0.1, 5.0, 10.0, 60.0, 90.0}) {
            const ClearSky sky(direction_at(77, sun_height), turbidity);
            for (const double azimuth : steps(0, 360, 30)) {
                for (const double height : {-90.0, -1.0, 0.0, 0.01, 3.0, 45.0, 90.0}) {
                    const LightSum light = sky.radiance(direction_at(azimuth, height));
                    for (const double v : light)
                        EXPECT_TRUE(v >= 0 && v < 1e3) << turbidity << " " << sun_height << " " << height << " " << v;
                    if (height < 0) {
                        EXPECT_EQ(light, LightSum{});
                    }
                }
            }
        }
    }
}

TEST(SkyModel, TheSkyIsBlueAndTheLowSunIsRed) {
    const ClearSky noon(direction_at(180, 60), 3), evening(direction_at(270, 1), 3);
    const LightSum blue = noon.radiance(direction_at(0, 60));
    EXPECT_GT(blue[2], 1.5 * blue[0]);
    const LightSum white = noon.sun()->irradiance, red = evening.sun()->irradiance;
    EXPECT_NEAR(white[2] / white[0], 0.75, 0.15);
    EXPECT_LT(red[2], 0.1 * red[0]);
    EXPECT_NEAR(luminance(white), 95, 15);
    EXPECT_LT(luminance(red), 10);
    EXPECT_GT(luminance(red), 0);
}

TEST(SkyModel, BrightestAroundTheSunAndEvenAtNight) {
    const ClearSky day(direction_at(120, 40), 3), night(direction_at(120, -30), 3);
    EXPECT_GT(luminance(day.radiance(direction_at(120, 40))), 3 * luminance(day.radiance(direction_at(300, 50))));
    const LightSum dark = night.radiance(direction_at(120, 1));
    for (const double azimuth : steps(0, 360, 45)) expect_near(night.radiance(direction_at(azimuth, 30)), dark, 1e-12);
    EXPECT_FALSE(night.sun());
}

TEST(SkyModel, TheSunGoesDownBitByBit) {
    const auto strength = [](double height) {
        const auto sun = ClearSky(direction_at(280, height), 2).sun();
        return sun ? luminance(sun->irradiance) : 0.0;
    };
    EXPECT_GT(strength(0.3), strength(0.0));
    EXPECT_GT(strength(0.0), strength(-0.2));
    EXPECT_GT(strength(-0.2), 0);
    EXPECT_EQ(strength(-0.3), 0);
}

TEST(SkyModel, AMapOfItHoldsItsLight) {
    const ClearSky sky(direction_at(200, 25), 3);
    const EnvironmentMap map = sky_map(sky, 64);
    ASSERT_EQ(map.texels.size(), 64u * 32);
    const Direction from = map_direction(64, 32, 10.5, 7.5);
    for (size_t c = 0; c < 3; ++c)
        EXPECT_FLOAT_EQ(map.texels[7 * 64 + 10][c], static_cast<float>(sky.radiance(from)[c]));
    EXPECT_EQ(map.texels.back(), (Rgb{0, 0, 0}));
}

TEST(SunPosition, StandsWhereTheAlmanacSays) {
    const auto height = [](const Direction& d) { return std::asin(d[2]) * 180 / M_PI; };
    const auto azimuth = [](const Direction& d) { return std::atan2(d[0], d[1]) * 180 / M_PI; };
    // Solstices and equinox: 90 - latitude + declination at noon.
    EXPECT_NEAR(height(sun_direction(48, 172, 12)), 90 - 48 + 23.44, 0.05);
    EXPECT_NEAR(height(sun_direction(48, 355, 12)), 90 - 48 - 23.44, 0.05);
    EXPECT_NEAR(height(sun_direction(48, 80, 12)), 90 - 48, 0.4);
    EXPECT_NEAR(height(sun_direction(0, 172, 12)), 90 - 23.44, 0.05);
    // In the south at noon, east in the morning, west in the evening; in the north from Sydney.
    EXPECT_NEAR(std::abs(azimuth(sun_direction(48, 172, 12))), 180, 1e-6);
    EXPECT_NEAR(azimuth(sun_direction(0, 80, 6.5)), 90, 1);
    EXPECT_NEAR(azimuth(sun_direction(0, 80, 17.5)), -90, 1);
    EXPECT_NEAR(azimuth(sun_direction(-34, 355, 12)), 0, 1e-6);
    // The sun does not set beyond the polar circle in June, and does not rise in December.
    EXPECT_GT(height(sun_direction(70, 172, 0)), 3);
    EXPECT_LT(height(sun_direction(70, 355, 12)), -3);
    // Berlin, 21 June: the day lasts 16 h 50 min with refraction, 16 h 36 min without.
    double day = 0;
    for (const double hour : steps(0, 24, 0.01)) day += sun_direction(52.52, 172, hour)[2] > 0 ? 0.01 : 0;
    EXPECT_NEAR(day, 16.6, 0.05);
}

TEST(SunPosition, DaysFollowOnEachOtherAndDirectionsAreUnitVectors) {
    for (const double hour : steps(-30, 60, 1.7)) {
        const Direction d = sun_direction(50, 100, hour), next = sun_direction(50, 101, hour - 24);
        EXPECT_NEAR(dot(d, d), 1, 1e-12);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(d[c], next[c], 1e-9);
    }
}

}  // namespace
}  // namespace citystream::client
