#include "client/select/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace citystream::client {
namespace {

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(Camera, YawIsClockwiseFromNorthAndPitchIsUp) {
    const Camera north = Camera::from_sample({0, 0, 0, 0, 0, 0, 60}, 100, 100);
    EXPECT_NEAR(north.forward[1], 1, 1e-12);
    EXPECT_NEAR(north.right[0], 1, 1e-12);
    EXPECT_NEAR(north.up[2], 1, 1e-12);
    const Camera east = Camera::from_sample({0, 0, 0, 0, 90, 0, 60}, 100, 100);
    EXPECT_NEAR(east.forward[0], 1, 1e-12);
    const Camera up = Camera::from_sample({0, 0, 0, 0, 30, 90, 60}, 100, 100);
    EXPECT_NEAR(up.forward[2], 1, 1e-12);
}

TEST(Camera, AxesAreOrthonormalAndRightHanded) {
    for (double yaw = -400; yaw < 400; yaw += 37) {
        for (double pitch = -90; pitch <= 90; pitch += 15) {
            const Camera camera = Camera::from_sample({0, 1, 2, 3, yaw, pitch, 45}, 64, 48);
            EXPECT_NEAR(dot(camera.right, camera.up), 0, 1e-12);
            EXPECT_NEAR(dot(camera.right, camera.forward), 0, 1e-12);
            EXPECT_NEAR(dot(camera.up, camera.forward), 0, 1e-12);
            EXPECT_NEAR(camera.right[0] * camera.forward[1] - camera.right[1] * camera.forward[0], camera.up[2], 1e-12);
        }
    }
}

TEST(Camera, OneMetreProjectsToHeightOverTwiceTheTangent) {
    const Camera camera = Camera::from_sample({0, 0, 0, 0, 0, 0, 90}, 1280, 720);
    EXPECT_NEAR(camera.pixels_per_metre(10), 36, 1e-9);
}

TEST(Camera, DistanceIsToTheNearestPointOfTheBox) {
    Camera camera;
    camera.position = {1000, 2000, 50};
    tiles::tileset::Bounds box;
    box.min = {10, 0, 0};
    box.max = {20, 10, 20};
    EXPECT_NEAR(camera.distance_to(box, {1000, 2000}), std::hypot(10, 30), 1e-9);
    EXPECT_EQ(camera.distance_to(box, {985, 1995}), 30);
    camera.position[2] = 10;
    EXPECT_EQ(camera.distance_to(box, {985, 1995}), 0);
}

TEST(Camera, NeverCullsABoxThatHoldsAPointInView) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-200, 200), size(0.1, 60), turn(-180, 180);
    uint32_t culled = 0;
    for (int i = 0; i < 2000; ++i) {
        const Camera camera = Camera::from_sample({0, 5e6, 6e6, 20, turn(random), turn(random) / 2, 50}, 320, 200);
        tiles::tileset::Bounds box;
        for (size_t a = 0; a < 3; ++a) {
            box.min[a] = place(random);
            box.max[a] = box.min[a] + size(random);
        }
        if (camera.sees(box, {5e6, 6e6})) continue;
        ++culled;
        for (int k = 0; k < 30; ++k) {
            std::array<double, 3> to{};
            for (size_t a = 0; a < 3; ++a) {
                const double origin = a == 0 ? 5e6 : a == 1 ? 6e6 : 0;
                const double s = k < 8 ? (k >> a & 1) : std::uniform_real_distribution<double>(0, 1)(random);
                to[a] = box.min[a] + s * (box.max[a] - box.min[a]) + origin - camera.position[a];
            }
            const double depth = dot(to, camera.forward), tangent = std::tan(camera.fov_y / 2);
            const bool inside = depth > camera.near_plane && std::abs(dot(to, camera.up)) < depth * tangent &&
                                std::abs(dot(to, camera.right)) < depth * tangent * 1.6;
            EXPECT_FALSE(inside);
        }
    }
    EXPECT_GT(culled, 500u);
}

}  // namespace
}  // namespace citystream::client
