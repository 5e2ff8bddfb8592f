#include "client/reference/sky_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;

EnvironmentMap uniform_sky(float radiance) {
    return {8, 4, std::vector<Rgb>(32, Rgb{radiance, radiance, radiance})};
}

/// Bright in the east, dark in the west.
EnvironmentMap uneven_sky() {
    EnvironmentMap map{64, 32, {}};
    for (uint32_t row = 0; row < map.height; ++row) {
        for (uint32_t column = 0; column < map.width; ++column) {
            const Direction d = map_direction(map.width, map.height, column + 0.5, row + 0.5);
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
            EXPECT_NEAR(dot(d, d), 1, 1e-12);
            EXPECT_GE(dot(d, normal), 0);
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
    const double scale = dot(u, n);
    if (scale == 0) return false;
    const double a = dot(s, n) / scale, b = dot(d, m) / scale;
    return a >= 0 && b >= 0 && a + b <= 1 && dot(v, m) / scale > 0;
}

TEST(SkyReference, AgreesWithEveryRayAgainstEveryTriangle) {
    auto triangles = ground_and_wall(300, 12, 1);
    for (const double x : {8.0, 17.0, 26.0, 35.0}) {
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

/// High in the east.
Sun eastern_sun() {
    Sun sun;
    sun.direction = {0.6, 0, 0.8};
    sun.irradiance = {10, 8, 6};
    return sun;
}

TEST(SkyReference, TheSunReachesWhatFacesItAndNothingBehindAWall) {
    const auto reference = reference_of(ground_and_wall(1000, 20, 1));
    const Sun sun = eastern_sun();
    const LightSum open = reference.sun_irradiance({5, 0, 0}, {0, 0, 1}, sun, 8, 1);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(open[c], 0.8 * sun.irradiance[c], 1e-4 * sun.irradiance[c]);
    // 20 m high, so 15 m long a shadow to the west.
    EXPECT_EQ(reference.sun_irradiance({-14.5, 0, 0}, {0, 0, 1}, sun, 8, 1), (LightSum{}));
    EXPECT_GT(reference.sun_irradiance({-15.5, 0, 0}, {0, 0, 1}, sun, 8, 1)[0], 7.9);
    EXPECT_EQ(reference.sun_irradiance({0, 0, 10}, {-1, 0, 0}, sun, 8, 1), (LightSum{})) << "it faces away";
}

TEST(SkyReference, TheEdgeOfAShadowIsAsSoftAsTheSunIsLarge) {
    const auto reference = reference_of(ground_and_wall(1000, 20, 1));
    Sun sun = eastern_sun();
    sun.angular_radius = 0.05;
    // A disc's edge passes over: half of it in the middle, some of it within its radius seen from the wall's top 25 m
    // away, whose shadow the slant makes longer by 1 / 0.8.
    const auto share = [&](double x) {
        return reference.sun_irradiance({x, 0, 0}, {0, 0, 1}, sun, 32, 1)[0] / (0.8 * sun.irradiance[0]);
    };
    EXPECT_NEAR(share(-15), 0.5, 0.04);
    EXPECT_EQ(share(-15 + 1.8), 0);
    EXPECT_GT(share(-15 + 1), 0);
    EXPECT_LT(share(-15 - 1), 1);
    EXPECT_NEAR(share(-15 - 1.8), 1, 0.01);
}

TEST(SkyReference, TheSunsDiscIsSeenWhereNothingIsMet) {
    const auto sky = uniform_sky(1);
    ReferenceLight light{&sky, &sky, eastern_sun()};
    const auto reference = reference_of({});
    const double yaw = 90, pitch = std::asin(0.8) * 180 / kPi;
    const auto picture = reference.draw(camera_at(0, 0, 0, yaw, pitch, 17, 17), light, {});
    const double radius = light.sun->angular_radius, solid_angle = 2 * kPi * (1 - std::cos(radius));
    EXPECT_NEAR(picture.pixels[8 * 17 + 8][0], 1 + 10 / solid_angle, 1);
    EXPECT_EQ(picture.pixels[0], (Rgb{1, 1, 1}));
}

TEST(SkyReference, APictureOfColoursTakesThePlaceOfTheTriangles) {
    const auto sky = uniform_sky(2);
    const auto dark = uniform_sky(0);
    const auto reference = reference_of(ground_and_wall(1000, 0, 0.4F));
    FrameImage colours{4, 4, std::vector<uint8_t>(4 * 4 * 4, 255)};
    colours.rgba[0] = colours.rgba[1] = 0;  // the first pixel's first place is blue
    const Camera camera = camera_at(0, 0, 10, 0, -90, 2, 2);
    const auto picture = reference.draw(camera, {&sky, &dark, {}}, {.across = 8, .pixel_across = 2}, &colours);
    EXPECT_NEAR(picture.pixels[0][0], 1.5, 1e-5);
    EXPECT_NEAR(picture.pixels[0][2], 2, 1e-5);
    EXPECT_NEAR(picture.pixels[3][0], 2, 1e-5);
}

/// One wall 4 m wide and high that stands on the ground, twice, and the ground.
GlbScene scene_of_instances() {
    GlbScene scene;
    scene.origin = {1000, 2000, 0};
    GlbGeometry wall, ground;
    wall.vertices = {{{-2, 0, 0}, {}, {}}, {{2, 0, 0}, {}, {}}, {{2, 0, 4}, {}, {}}, {{-2, 0, 4}, {}, {}}};
    wall.indices = {0, 1, 2, 0, 2, 3};
    ground.vertices = {{{-50, -50, 0}, {}, {}}, {{50, -50, 0}, {}, {}}, {{50, 50, 0}, {}, {}}, {{-50, 50, 0}, {}, {}}};
    ground.indices = {0, 1, 2, 0, 2, 3};
    scene.geometries = {wall, ground};
    scene.meshes = {{{0, 0}}, {{1, 0}}};
    const GlbTransform beside = {1, 0, 0, 0, 1, 0, 0, 0, 1, 8, 5, 0};
    const GlbTransform turned = {0, 1, 0, -1, 0, 0, 0, 0, 1, -8, 5, 0};
    const GlbTransform still = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    scene.draws = {{0, {beside, turned}}, {1, {still}}};
    return scene;
}

TEST(SkyReference, InstancesGiveThePictureOfTheirTrianglesSpelledOut) {
    const GlbScene scene = scene_of_instances();
    auto spelled = ground_and_wall(50, 0, 0.5F);
    add_quad(spelled, {{{6, 5, 0}, {10, 5, 0}, {10, 5, 4}, {6, 5, 4}}}, 0.5F);
    add_quad(spelled, {{{-8, 3, 0}, {-8, 7, 0}, {-8, 7, 4}, {-8, 3, 4}}}, 0.5F);
    const auto sky = uneven_sky();
    const ReferenceLight light{&sky, &sky, eastern_sun()};
    const Camera camera = camera_at(1001, 1985, 6, 4, -11, 48, 32);
    const auto instanced = SkyReference::create(scene, {0.5F, 0.5F, 0.5F});
    ASSERT_TRUE(instanced) << instanced.error().text();
    EXPECT_EQ(instanced->triangles(), 6u);
    const auto picture = instanced->draw(camera, light, {.across = 4});
    const auto expected = reference_of(spelled, scene.origin).draw(camera, light, {.across = 4});
    EXPECT_EQ(picture.surface, expected.surface);
    size_t differ = 0;
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
        for (size_t c = 0; c < 3; ++c)
            differ += std::abs(picture.pixels[i][c] - expected.pixels[i][c]) > 0.02F * expected.pixels[i][c] ? 1 : 0;
    }
    EXPECT_LE(differ, picture.pixels.size() / 100) << "rays that only just meet an edge";
    EXPECT_FALSE(std::all_of(picture.pixels.begin(), picture.pixels.end(),
                             [&](const Rgb& pixel) { return pixel == picture.pixels[0]; }));
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
}  // namespace citystream::client
