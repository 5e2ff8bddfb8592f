#include "tests/bench/sky_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::bench {
namespace {

using client::Camera;
using client::Direction;
using client::EnvironmentMap;
using client::LightSum;
using client::Rgb;

constexpr double kPi = std::numbers::pi;

EnvironmentMap uniform_sky(float radiance) {
    return {8, 4, std::vector<Rgb>(32, Rgb{radiance, radiance, radiance})};
}

/// Bright in the east, dark in the west.
EnvironmentMap uneven_sky() {
    EnvironmentMap map{64, 32, {}};
    for (uint32_t row = 0; row < map.height; ++row) {
        for (uint32_t column = 0; column < map.width; ++column) {
            const Direction d = client::map_direction(map.width, map.height, column + 0.5, row + 0.5);
            const auto value = static_cast<float>(std::exp(2 * d[0]) + (d[2] > 0.5 ? 3 : 0));
            map.texels.push_back({value, 0.5F * value, 1});
        }
    }
    return map;
}

void add_quad(std::vector<ReferenceTriangle>& triangles, const std::array<Direction, 4>& p, float albedo) {
    triangles.push_back({{p[0], p[1], p[2]}, {albedo, albedo, albedo}});
    triangles.push_back({{p[0], p[2], p[3]}, {albedo, albedo, albedo}});
}

/// Ground of `far` metres to all sides, and a wall along y at x = 0.
std::vector<ReferenceTriangle> ground_and_wall(double far, double wall_height, float albedo) {
    std::vector<ReferenceTriangle> triangles;
    add_quad(triangles, {{{-far, -far, 0}, {far, -far, 0}, {far, far, 0}, {-far, far, 0}}}, albedo);
    if (wall_height > 0) {
        const double h = wall_height;
        add_quad(triangles, {{{0, -far, 0}, {0, far, 0}, {0, far, h}, {0, -far, h}}}, albedo);
    }
    return triangles;
}

SkyReference reference_of(const std::vector<ReferenceTriangle>& triangles, const std::array<double, 3>& origin = {}) {
    auto reference = SkyReference::create(triangles, origin);
    EXPECT_TRUE(reference) << reference.error().text();
    return std::move(*reference);
}

/// Degrees.
Camera camera_at(double x, double y, double z, double yaw, double pitch, uint32_t width, uint32_t height) {
    return Camera::from_sample({.x = x, .y = y, .z = z, .yaw = yaw, .pitch = pitch}, width, height);
}

TEST(SkyReference, OpenGroundUnderAUniformSkyShowsItsAlbedo) {
    const auto reference = reference_of(ground_and_wall(1000, 0, 0.4F));
    const auto picture = reference.draw(camera_at(0, 0, 10, 0, -90, 16, 9), uniform_sky(2), {.across = 8});
    for (const Rgb& pixel : picture.pixels) EXPECT_NEAR(pixel[1], 0.4 * 2, 1e-5);
    EXPECT_EQ(picture.surface, std::vector<uint8_t>(picture.pixels.size(), 1));
}

TEST(SkyReference, WhereNothingIsMetTheEnvironmentShows) {
    const auto sky = uneven_sky();
    const Camera camera = camera_at(5e5, 5e6, 10, 60, 30, 16, 9);
    const auto picture = reference_of({}, {5e5, 5e6, 0}).draw(camera, sky, {});
    const Rgb middle = sky.radiance(camera.forward);
    EXPECT_EQ(picture.surface, std::vector<uint8_t>(picture.pixels.size(), 0));
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(picture.pixels[4 * 16 + 8][c], middle[c], 0.1F * middle[c]);
}

TEST(SkyReference, GroundAtAnEndlessWallGetsTheClosedForm) {
    constexpr double kHeight = 20;
    const auto reference = reference_of(ground_and_wall(15000, kHeight, 1));
    for (const double x : {2.0, 10.0, 20.0, 60.0}) {
        const auto light = reference.irradiance({x, 0, 0}, {0, 0, 1}, uniform_sky(1), 64, 7);
        EXPECT_NEAR(light[0] / kPi / ((1 + std::cos(std::atan(kHeight / x))) / 2), 1, 0.004) << x;
    }
    for (const double z : {1.0, 10.0, 19.0}) {
        // The ground hides the lower half of what a wall sees, and has no light of its own.
        const auto light = reference.irradiance({0, 0, z}, {1, 0, 0}, uniform_sky(1), 64, 7);
        EXPECT_NEAR(light[0] / kPi, 0.5, 0.004) << z;
    }
}

TEST(SkyReference, RaysAreSpreadByTheCosine) {
    for (const Direction& normal : {Direction{0, 0, 1}, {0, 0, -1}, {0.6, 0, 0.8}, {-0.48, 0.64, -0.6}}) {
        Direction mean{};
        constexpr uint32_t kAcross = 64;
        for (uint32_t ray = 0; ray < kAcross * kAcross; ++ray) {
            const Direction d = cosine_direction(normal, ray, kAcross, 3);
            EXPECT_NEAR(client::dot(d, d), 1, 1e-12);
            EXPECT_GE(client::dot(d, normal), 0);
            for (size_t c = 0; c < 3; ++c) mean[c] += d[c] / (kAcross * kAcross);
        }
        // The mean of the cosine by the cosine is 2 / 3.
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], normal[c] * 2 / 3, 2e-3);
    }
}

/// Moeller and Trumbore 1997.
bool is_met(const ReferenceTriangle& triangle, const Direction& from, const Direction& d) {
    const auto& [p, q, r] = triangle.corners;
    const auto minus = [](const Direction& a, const Direction& b) {
        return Direction{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    };
    const auto cross = [](const Direction& a, const Direction& b) {
        return Direction{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Direction u = minus(q, p), v = minus(r, p), s = minus(from, p), n = cross(d, v), m = cross(s, u);
    const double scale = client::dot(u, n);
    if (scale == 0) return false;
    const double a = client::dot(s, n) / scale, b = client::dot(d, m) / scale;
    return a >= 0 && b >= 0 && a + b <= 1 && client::dot(v, m) / scale > 0;
}

TEST(SkyReference, AgreesWithEveryRayAgainstEveryTriangle) {
    auto triangles = ground_and_wall(300, 12, 1);
    for (double x = 8; x < 40; x += 9) {
        add_quad(triangles, {{{x, 3, 0}, {x, 8, 0}, {x, 8, x / 2}, {x, 3, x / 2}}}, 1);
        add_quad(triangles, {{{x, 3, x / 2}, {x, 8, x / 2}, {x + 4, 8, x / 2}, {x + 4, 3, x / 2}}}, 1);
    }
    const auto reference = reference_of(triangles);
    const auto sky = uneven_sky();
    constexpr uint32_t kAcross = 16;
    const Direction normal = {0, 0, 1};
    for (uint64_t place = 0; place < 30; ++place) {
        const Direction point = {1.3 + 1.7 * static_cast<double>(place), 0.37 * static_cast<double>(place), 0};
        LightSum expected{};
        for (uint32_t ray = 0; ray < kAcross * kAcross; ++ray) {
            const Direction d = cosine_direction(normal, ray, kAcross, place);
            const Direction from = {point[0], point[1], kRayLift};
            if (std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) { return is_met(t, from, d); }))
                continue;
            for (size_t c = 0; c < 3; ++c) expected[c] += sky.radiance(d)[c] * kPi / (kAcross * kAcross);
        }
        const LightSum light = reference.irradiance(point, normal, sky, kAcross, place);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(light[c], expected[c], 0.005 * expected[c]) << place;
    }
}

TEST(SkyReference, PicturesDoNotDependOnTheNumberOfThreadsOrTheCitysPlace) {
    const auto triangles = ground_and_wall(100, 12, 0.5F);
    const auto sky = uneven_sky();
    const auto one = reference_of(triangles).draw(camera_at(9, -20, 6, -17, -11, 24, 16), sky,
                                                  {.across = 4, .pixel_across = 2, .jobs = 1});
    const std::array<double, 3> far = {1048576, 4194304, 64};
    const auto other = reference_of(triangles, far)
                           .draw(camera_at(9 + far[0], -20 + far[1], 6 + far[2], -17, -11, 24, 16), sky,
                                 {.across = 4, .pixel_across = 2, .jobs = 3});
    size_t differ = 0;
    for (size_t i = 0; i < one.pixels.size(); ++i) differ += one.pixels[i] == other.pixels[i] ? 0 : 1;
    EXPECT_LE(differ, one.pixels.size() / 100) << "a camera's place is rounded where the city is far away";
    const auto again = reference_of(triangles).draw(camera_at(9, -20, 6, -17, -11, 24, 16), sky,
                                                    {.across = 4, .pixel_across = 2, .jobs = 3});
    EXPECT_EQ(one.pixels, again.pixels);
}

TEST(SkyReference, ShownPicturesFollowTheToneCurve) {
    const auto image = shown_picture({2, 1, {{0, 0.25F, 1e9F}, {0.5F, 0.5F, 0.5F}}, {1, 1}}, 0.5);
    EXPECT_EQ(image.rgba[0], 0);
    EXPECT_EQ(image.rgba[1], 99);  // sRGB of an eighth
    EXPECT_EQ(image.rgba[2], 255);
    EXPECT_EQ(image.rgba[3], 255);
    EXPECT_EQ(image.rgba[4], 137);  // sRGB of a quarter
}

}  // namespace
}  // namespace citystream::bench
