#include "client/select/caster_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace citystream::client {
namespace {

using tiles::tileset::Bounds;
using Vector = std::array<double, 3>;

constexpr std::array<double, 2> kOrigin = {5000, -3000};

Camera camera_at(double x, double y, double z, double yaw, double pitch) {
    return Camera::from_sample({0, kOrigin[0] + x, kOrigin[1] + y, z, yaw, pitch, 60}, 640, 480);
}

/// Clockwise from north, and up.
Vector towards(double yaw, double elevation) {
    const double a = yaw * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
    return {std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e)};
}

Bounds box_around(const Vector& point, double half) {
    Bounds bounds;
    for (size_t c = 0; c < 3; ++c) {
        const double centre = point[c] - (c < 2 ? kOrigin[c] : 0);
        bounds.min[c] = centre - half;
        bounds.max[c] = centre + half;
    }
    return bounds;
}

/// Whether a point is in the view's part that takes shadows.
bool is_seen(const Camera& camera, const CasterLimits& limits, const Vector& point) {
    Vector from{};
    for (size_t c = 0; c < 3; ++c) from[c] = point[c] - camera.position[c];
    const auto along = [&](const Vector& axis) { return from[0] * axis[0] + from[1] * axis[1] + from[2] * axis[2]; };
    const double depth = along(camera.forward), tan_y = std::tan(camera.fov_y / 2);
    const double tan_x = tan_y * camera.width / camera.height;
    return depth > 0 && depth <= limits.view_metres && std::abs(along(camera.right)) <= tan_x * depth &&
           std::abs(along(camera.up)) <= tan_y * depth && point[2] >= limits.lowest && point[2] <= limits.highest;
}

Vector moved(const Vector& point, const Vector& axis, double way) {
    return {point[0] + axis[0] * way, point[1] + axis[1] * way, point[2] + axis[2] * way};
}

TEST(CasterVolume, HoldsAllThatCastsAShadowIntoTheView) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    uint32_t tried = 0;
    for (int k = 0; k < 200; ++k) {
        const Camera camera = camera_at(0, 0, 2 + 300 * unit(random), 360 * unit(random), 80 - 160 * unit(random));
        const CasterLimits limits = {towards(360 * unit(random), 2 + 87 * unit(random)), 100 + 900 * unit(random), 2048,
                                     -10, 90};
        const CasterVolume volume(camera, limits);
        for (int i = 0; i < 200; ++i) {
            const double depth = limits.view_metres * unit(random), x = 2 * unit(random) - 1, y = 2 * unit(random) - 1;
            Vector point = moved(camera.position, camera.forward, depth);
            point = moved(point, camera.right, x * depth);
            point = moved(point, camera.up, y * depth);
            if (!is_seen(camera, limits, point)) continue;
            // Some way towards the sun, but not above the city.
            const double most = std::min(2048.0, (limits.highest - point[2]) / limits.to_sun[2]);
            const double way = most * unit(random);
            const Bounds caster = box_around(moved(point, limits.to_sun, way), 4 * unit(random));
            ASSERT_TRUE(volume.meets(caster, kOrigin));
            EXPECT_LE(volume.shadow_distance(caster, kOrigin),
                      std::hypot(point[0] - camera.position[0], point[1] - camera.position[1],
                                 point[2] - camera.position[2]) +
                          0.1);
            ++tried;
        }
    }
    EXPECT_GT(tried, 2000U);
}

/// Seen as rays from a box's points away from the sun: most boxes of which none meets the view are known to.
TEST(CasterVolume, LeavesOutMostOfWhatDoesNot) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    uint32_t casting = 0, kept = 0, boxes = 0;
    for (int k = 0; k < 20; ++k) {
        const Camera camera = camera_at(0, 0, 30, 360 * unit(random), -10);
        const CasterLimits limits = {towards(360 * unit(random), 15 + 30 * unit(random)), 300, 2048, 0, 60};
        const CasterVolume volume(camera, limits);
        for (int i = 0; i < 200; ++i) {
            const Vector centre = {kOrigin[0] + 1200 * unit(random) - 600, kOrigin[1] + 1200 * unit(random) - 600, 25};
            bool casts = false;
            for (int j = 0; j < 400 && !casts; ++j) {
                Vector point = centre;
                for (double& c : point) c += 50 * unit(random) - 25;
                casts =
                    is_seen(camera, limits, moved(point, limits.to_sun, -point[2] / limits.to_sun[2] * unit(random)));
            }
            const bool meets = volume.meets(box_around(centre, 25), kOrigin);
            EXPECT_TRUE(meets || !casts);
            ++boxes;
            casting += casts ? 1 : 0;
            kept += meets ? 1 : 0;
        }
    }
    EXPECT_GT(casting, 200U);
    EXPECT_LT(kept, casting + boxes / 20) << casting << " of " << boxes;
}

TEST(CasterVolume, AViewOfTheSkyAboveTheCityIsEmpty) {
    const CasterLimits limits = {towards(90, 30), 3840, 2048, 0, 50};
    const CasterVolume volume(camera_at(0, 0, 60, 10, 40), limits);
    for (const double x : {-200.0, 0.0, 200.0})
        EXPECT_FALSE(volume.meets(box_around({kOrigin[0] + x, kOrigin[1], 25}, 25), kOrigin));
}

TEST(CasterVolume, TheReachIsThatOfTheCitysHeightAndHasALimit) {
    // North of the camera is in view, the sun stands in the south.
    const Camera camera = camera_at(0, 0, 2, 0, 0);
    const auto farthest_south = [&](double elevation, double height, double most) {
        const CasterVolume volume(camera, {towards(180, elevation), 500, most, 0, height});
        double south = 0;
        for (int y = 0; y < 4000; y += 5) {
            if (volume.meets(box_around({kOrigin[0], kOrigin[1] - y, height / 2}, height / 2), kOrigin)) south = y;
        }
        return south;
    };
    EXPECT_NEAR(farthest_south(45, 100, 2048), 150, 60);  // and half a box
    EXPECT_NEAR(farthest_south(10, 100, 2048), 100 / std::tan(10 * std::numbers::pi / 180) + 50, 60);
    EXPECT_NEAR(farthest_south(1, 100, 2048), 2048 + 50, 60);
    EXPECT_NEAR(farthest_south(1, 100, 300), 300 + 50, 60);
}

TEST(CasterVolume, AShadowIsAsNearAsItsNearestPlace) {
    const Camera camera = camera_at(0, 0, 2, 0, 0);
    // A tower behind the camera whose shadow falls over it, and one in front whose shadow falls away.
    const CasterVolume volume(camera, {towards(180, 45), 500, 2048, 0, 100});
    EXPECT_LT(volume.shadow_distance(box_around({kOrigin[0], kOrigin[1] - 50, 50}, 10), kOrigin), 5);
    EXPECT_NEAR(volume.shadow_distance(box_around({kOrigin[0], kOrigin[1] + 110, 12}, 10), kOrigin), 100, 0.2);
}

}  // namespace
}  // namespace citystream::client
