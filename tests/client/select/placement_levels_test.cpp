#include "client/select/placement_levels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace citystream::client {
namespace {

using codec::facade::Placement;
using tiles::tileset::FacadeMapRecord;

constexpr int32_t kMetre = 1024;

/// Map 0 has texels of 16, 4 and 1 cm, map 1 of 1 cm alone.
FacadeDictionary dictionary() {
    std::vector<FacadeMapRecord> maps(2);
    for (const uint16_t texel : std::initializer_list<uint16_t>{16, 4, 1})
        maps[0].level[maps[0].level_count++].texel_cm = texel;
    maps[1].level_count = 1;
    FacadeDictionary out;
    out.learn(std::move(maps));
    return out;
}

/// 10 m along x, 5 m high.
Placement wall_at(double x, double y, uint32_t map = 0) {
    return {
        {static_cast<int32_t>(x * kMetre), static_cast<int32_t>(y * kMetre), 0}, {10 * kMetre, 0}, 5 * kMetre, map, 0};
}

/// One metre is 1000 pixels at distance 1.
Camera camera_at(double x, double y, double z) {
    Camera camera = Camera::from_sample({0, x, y, z, 0, 0, 60}, 640, 480);
    camera.fov_y = 2 * std::atan(480.0 / 2000.0);
    return camera;
}

TEST(PlacementLevels, DistanceIsToTheNearestPointOfTheWall) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-40, 40), side(-20, 20), tall(0, 15);
    for (int i = 0; i < 50; ++i) {
        const GridPoint origin = {int64_t{1} << 33, -(int64_t{1} << 32), 7 * kMetre};
        const Placement wall = {
            {static_cast<int32_t>(place(random) * kMetre), static_cast<int32_t>(place(random) * kMetre),
             static_cast<int32_t>(tall(random) * kMetre)},
            {static_cast<int32_t>(side(random) * kMetre), static_cast<int32_t>(side(random) * kMetre)},
            static_cast<uint32_t>(tall(random) * kMetre),
            0,
            0};
        Camera camera =
            camera_at(to_metres(origin.x) + place(random), to_metres(origin.y) + place(random), place(random));
        double nearest = std::numeric_limits<double>::infinity();
        constexpr int kSteps = 400;
        for (int u = 0; u <= kSteps; ++u) {
            for (int v = 0; v <= kSteps; ++v) {
                const double across = static_cast<double>(u) / kSteps, up = static_cast<double>(v) / kSteps;
                const double x = to_metres(origin.x + wall.origin[0]) + across * to_metres(wall.along[0]);
                const double y = to_metres(origin.y + wall.origin[1]) + across * to_metres(wall.along[1]);
                const double z = to_metres(origin.z + wall.origin[2]) + up * to_metres(wall.height);
                nearest = std::min(nearest,
                                   std::hypot(x - camera.position[0], y - camera.position[1], z - camera.position[2]));
            }
        }
        const double got = distance_to_wall(camera, origin, wall);
        EXPECT_LE(got, nearest + 1e-9);
        EXPECT_GE(got, nearest - 0.1);
    }
    EXPECT_EQ(distance_to_wall(camera_at(5, 0, 2), {}, wall_at(0, 0)), camera_at(0, 0, 0).near_plane);
}

// In one tile, and though all show one map.
TEST(PlacementLevels, EachPlacementWantsTheLevelOfItsOwnDistance) {
    const FacadeDictionary maps = dictionary();
    // Texels of 16 cm are a quarter of a pixel at 640 m, of 4 cm at 160 m.
    const Camera camera = camera_at(5, 0, 2);
    const std::vector<Placement> walls = {wall_at(0, 10),  wall_at(0, 159),  wall_at(0, 161),    wall_at(0, 639),
                                          wall_at(0, 641), wall_at(0, 9000), wall_at(0, 9000, 1)};
    const auto levels = placement_levels(maps, camera, {}, walls, {0.25, {}});
    ASSERT_EQ(levels.size(), walls.size());
    const MapPiece expected[] = {map_piece(0, 2), map_piece(0, 2), map_piece(0, 1), map_piece(0, 1),
                                 map_piece(0, 0), map_piece(0, 0), map_piece(1, 0)};
    for (size_t i = 0; i < walls.size(); ++i) EXPECT_EQ(levels[i].piece, expected[i]) << i;
    EXPECT_NEAR(levels[0].pixels_per_metre, 100, 1e-6);
    EXPECT_EQ(distinct_pieces(levels),
              (std::vector<MapPiece>{map_piece(0, 0), map_piece(0, 1), map_piece(0, 2), map_piece(1, 0)}));
}

TEST(PlacementLevels, TheExactLevelIsWantedOnlyWhereSomePlacementNeedsIt) {
    const FacadeDictionary maps = dictionary();
    std::vector<Placement> walls = {wall_at(0, 300), wall_at(50, 500), wall_at(-70, 900)};
    const auto wanted = [&] {
        return distinct_pieces(placement_levels(maps, camera_at(5, 0, 2), {}, walls, {0.25, {}}));
    };
    EXPECT_EQ(wanted(), (std::vector<MapPiece>{map_piece(0, 0), map_piece(0, 1)}));
    walls.push_back(wall_at(0, 20));
    EXPECT_EQ(wanted(), (std::vector<MapPiece>{map_piece(0, 0), map_piece(0, 1), map_piece(0, 2)}));
}

TEST(PlacementLevels, AForcedLevelHoldsEverywhereAndUnknownMapsWantNothing) {
    const FacadeDictionary maps = dictionary();
    const std::vector<Placement> walls = {wall_at(0, 10), wall_at(0, 9000), wall_at(0, 10, 7)};
    const auto levels = placement_levels(maps, camera_at(5, 0, 2), {}, walls, {0.25, 1});
    EXPECT_EQ(levels[0].piece, map_piece(0, 1));
    EXPECT_EQ(levels[1].piece, map_piece(0, 1));
    EXPECT_EQ(levels[2].piece, kNoPiece);
    EXPECT_EQ(distinct_pieces(levels), (std::vector<MapPiece>{map_piece(0, 1)}));
}

}  // namespace
}  // namespace citystream::client
