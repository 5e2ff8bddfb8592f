#include "client/select/depth_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace citystream::client {
namespace {

using Point = std::array<double, 3>;
using Polygon = std::vector<Point>;
using tiles::tileset::Bounds;

constexpr std::array<double, 2> kOrigin = {500000, 5400000};

Camera camera_at(const Point& position, double yaw, double pitch, uint32_t width = 160, uint32_t height = 90) {
    CameraSample sample{};
    sample.x = kOrigin[0] + position[0];
    sample.y = kOrigin[1] + position[1];
    sample.z = position[2];
    sample.yaw = yaw;
    sample.pitch = pitch;
    sample.fov = 60;
    return Camera::from_sample(sample, width, height);
}

Polygon absolute(Polygon polygon) {
    for (Point& p : polygon) {
        p[0] += kOrigin[0];
        p[1] += kOrigin[1];
    }
    return polygon;
}

/// North of the origin, across the view: x from left to right.
Polygon wall(double left, double right, double low, double high, double north) {
    return absolute({{left, north, low}, {right, north, low}, {right, north, high}, {left, north, high}});
}

DepthPicture picture_of(const Camera& camera, const std::vector<Polygon>& polygons, uint32_t margin = 1) {
    DepthPicture picture;
    picture.begin(camera, margin);
    for (const Polygon& polygon : polygons) picture.add(polygon);
    picture.finish();
    return picture;
}

TEST(DepthPicture, AWallHidesWhatLiesBehindAllOfItAndNothingElse) {
    const Camera camera = camera_at({0, 0, 5}, 0, 0);
    const auto picture = picture_of(camera, {wall(-10, 10, 0, 10, 20)});
    EXPECT_TRUE(picture.hides({{-5, 30, 3}, {5, 50, 8}}, kOrigin));
    EXPECT_FALSE(picture.hides({{-5, 10, 3}, {5, 15, 8}}, kOrigin)) << "in front of it";
    EXPECT_FALSE(picture.hides({{-5, 15, 3}, {5, 50, 8}}, kOrigin)) << "reaches through it";
    EXPECT_FALSE(picture.hides({{-5, 30, 3}, {5, 50, 30}}, kOrigin)) << "rises above it";
    EXPECT_FALSE(picture.hides({{-40, 30, 3}, {5, 50, 8}}, kOrigin)) << "shows beside it";
    EXPECT_FALSE(picture.hides({{-5, -50, 3}, {5, 50, 8}}, kOrigin)) << "holds the camera";
    EXPECT_FALSE(picture.hides({{-9, 20, 1}, {9, 20, 9}}, kOrigin)) << "is the wall itself";
}

TEST(DepthPicture, HidesNothingThroughAGapOfOneSample) {
    const Camera camera = camera_at({0, 0, 5}, 0, 0);
    const double sample = 20 / camera.pixels_per_metre(1);  // metres a sample covers at the wall
    const Bounds behind{{-5, 30, 3}, {5, 50, 8}};
    EXPECT_TRUE(picture_of(camera, {wall(-10, 0, 0, 10, 20), wall(0, 10, 0, 10, 20)}).hides(behind, kOrigin));
    EXPECT_FALSE(
        picture_of(camera, {wall(-10, 0, 0, 10, 20), wall(1.01 * sample, 10, 0, 10, 20)}).hides(behind, kOrigin));
}

TEST(DepthPicture, TakesSurfacesSmallerByItsMargin) {
    const Camera camera = camera_at({0, 0, 5}, 0, 0);
    const double sample = 20 / camera.pixels_per_metre(1);
    const std::vector<Polygon> walls = {wall(-10, 10, 0, 10, 20)};
    // The box ends `inside` samples from the wall's right edge, as seen from the camera.
    const auto box = [&](double inside) { return Bounds{{0, 40, 4}, {(10 - inside * sample) * 2, 41, 6}}; };
    EXPECT_TRUE(picture_of(camera, walls, 1).hides(box(4), kOrigin));
    EXPECT_FALSE(picture_of(camera, walls, 1).hides(box(0.5), kOrigin));
    EXPECT_TRUE(picture_of(camera, walls, 4).hides(box(7), kOrigin));
    EXPECT_FALSE(picture_of(camera, walls, 4).hides(box(4), kOrigin));
}

TEST(DepthPicture, SurfacesThatReachBehindTheCameraAreCut) {
    const Camera camera = camera_at({0, 0, 5}, 0, 0);
    // A street's side from far behind to far ahead.
    const Polygon side = absolute({{4, -100, 0}, {4, 100, 0}, {4, 100, 20}, {4, -100, 20}});
    const auto picture = picture_of(camera, {side});
    EXPECT_TRUE(picture.hides({{10, 20, 3}, {12, 22, 8}}, kOrigin));
    EXPECT_FALSE(picture.hides({{-12, 20, 3}, {-10, 22, 8}}, kOrigin));
    EXPECT_GT(picture.covered(), 0.2);
}

TEST(DepthPicture, NothingIsHiddenByNothing) {
    const Camera camera = camera_at({0, 0, 5}, 0, 0);
    EXPECT_FALSE(picture_of(camera, {}).hides({{-5, 30, 3}, {5, 50, 8}}, kOrigin));
    EXPECT_FALSE(DepthPicture().hides({{-5, 30, 3}, {5, 50, 8}}, kOrigin));
    EXPECT_FALSE(picture_of(camera, {absolute({{0, 10, 0}, {0, 20, 0}, {0, 20, 10}})}).covered() > 0) << "edge on";
}

/// Distance along the view direction at which a ray enters a box; nothing where it misses.
std::optional<double> enters(const Camera& camera, const Point& direction, const Bounds& box) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    for (size_t axis = 0; axis < 3; ++axis) {
        const double shift = axis < 2 ? kOrigin[axis] : 0;
        const double a = (box.min[axis] + shift - camera.position[axis]) / direction[axis];
        const double b = (box.max[axis] + shift - camera.position[axis]) / direction[axis];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    if (from > to) return std::nullopt;
    return from;
}

/// The same for a rectangle across the north axis.
std::optional<double> meets(const Camera& camera, const Point& direction, const Polygon& polygon) {
    const double t = (polygon[0][1] - camera.position[1]) / direction[1];
    const double x = camera.position[0] + t * direction[0], z = camera.position[2] + t * direction[2];
    if (!(t > 0) || x < polygon[0][0] || x > polygon[1][0] || z < polygon[0][2] || z > polygon[2][2])
        return std::nullopt;
    return t;
}

TEST(DepthPicture, WhatItHidesShowsInNoSample) {
    std::mt19937_64 random(7);
    const auto roll = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    uint32_t hidden = 0, shown = 0;
    for (int scene = 0; scene < 60; ++scene) {
        const Camera camera = camera_at({roll(-5, 5), roll(-5, 5), roll(1, 20)}, roll(-25, 25), roll(-15, 15), 96, 54);
        std::vector<Polygon> walls;
        for (int i = 0; i < 12; ++i) {
            const double x = roll(-40, 40), z = roll(-5, 10);
            walls.push_back(wall(x, x + roll(5, 60), z, z + roll(5, 40), roll(15, 60)));
        }
        const DepthPicture picture = picture_of(camera, walls);
        for (int i = 0; i < 20; ++i) {
            const double x = roll(-60, 60), y = roll(20, 150), z = roll(-5, 25);
            const Bounds box{{x, y, z}, {x + roll(0.5, 30), y + roll(0.5, 30), z + roll(0.5, 20)}};
            const bool hides = picture.hides(box, kOrigin);
            ++(hides ? hidden : shown);
            if (!hides) continue;
            for (uint32_t row = 0; row < camera.height; ++row) {
                for (uint32_t column = 0; column < camera.width; ++column) {
                    const double tan = std::tan(camera.fov_y / 2) * 2 / camera.height;
                    const double u = (column + 0.5 - camera.width * 0.5) * tan,
                                 v = (camera.height * 0.5 - row - 0.5) * tan;
                    Point direction{};
                    for (size_t axis = 0; axis < 3; ++axis)
                        direction[axis] = camera.forward[axis] + u * camera.right[axis] + v * camera.up[axis];
                    const auto at = enters(camera, direction, box);
                    if (!at) continue;
                    bool covered = false;
                    for (const Polygon& polygon : walls) {
                        const auto t = meets(camera, direction, polygon);
                        covered = covered || (t && *t < *at);
                    }
                    ASSERT_TRUE(covered) << scene << " " << column << " " << row;
                }
            }
        }
    }
    EXPECT_GT(hidden, 100U);
    EXPECT_GT(shown, 100U);
}

}  // namespace
}  // namespace citystream::client
