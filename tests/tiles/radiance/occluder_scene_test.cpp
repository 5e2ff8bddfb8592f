#include "tiles/radiance/occluder_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "codec/radiance/source_directions.h"
#include "tests/tiles/radiance/box_city.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::Surface;
using Side = OccluderScene::Side;

constexpr StartBox kTile = {{0, 0, 0}, {128 << kGridBits, 128 << kGridBits, 100 << kGridBits}};
constexpr RayDirection kUp = {0, 0, 1}, kDown = {0, 0, -1}, kEast = {1, 0, 0};

std::vector<RayDirection> cube_directions(uint32_t side) {
    std::vector<RayDirection> directions;
    for (uint32_t cell = 0; cell < codec::radiance::cube_cells(side); ++cell) {
        directions.push_back(ray_direction(codec::radiance::cell_direction(side, cell)));
    }
    return directions;
}

bool blocked(const OccluderScene& scene, const GridPoint& from, const RayDirection& direction) {
    uint64_t word = ~uint64_t{0};
    scene.blocked(from, {&direction, 1}, {&word, 1});
    EXPECT_LE(word, 1U);
    return word == 1;
}

std::vector<uint64_t> all_blocked(const OccluderScene& scene, const GridPoint& from,
                                  std::span<const RayDirection> directions) {
    std::vector<uint64_t> words((directions.size() + 63) / 64);
    scene.blocked(from, directions, words);
    return words;
}

TEST(OccluderScene, WithoutTrianglesNothingIsInTheWay) {
    const auto scene = OccluderScene::create({}, nullptr, kTile);
    ASSERT_TRUE(scene) << scene.error().text();
    const auto directions = cube_directions(3);
    for (const uint64_t word : all_blocked(*scene, at(10, 10, 1), directions)) EXPECT_EQ(word, 0U);
    EXPECT_EQ(scene->nearest_side(at(10, 10, 1), kDown), Side::kNothing);
}

TEST(OccluderScene, KnowsFrontsFromBacksAndTheNearestOfThem) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(64, 64, 16, 20));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->nearest_side(at(20, 64, 5), kDown), Side::kFront);
    EXPECT_EQ(scene->nearest_side(at(20, 64, 5), kEast), Side::kFront);
    EXPECT_EQ(scene->nearest_side(at(20, 64, 5), kUp), Side::kNothing);
    EXPECT_EQ(scene->nearest_side(at(64, 64, 5), kEast), Side::kBack);
    EXPECT_EQ(scene->nearest_side(at(64, 64, 5), kUp), Side::kBack);
    EXPECT_EQ(scene->nearest_side(at(64, 64, 25), kDown), Side::kFront);
    EXPECT_EQ(scene->nearest_side(at(64, 64, -5), kUp), Side::kBack);
}

TEST(OccluderScene, ARayGoesToTheNearestSurfaceWhicheverSideItHas) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(64, 64, 16, 20));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    EXPECT_NEAR(scene->free_way(at(20, 64, 5), kDown, 50), 5, 1e-4);
    EXPECT_NEAR(scene->free_way(at(20, 64, 5), kEast, 50), 36, 1e-4);
    EXPECT_NEAR(scene->free_way(at(64, 64, 5), kEast, 50), 8, 1e-4) << "a back";
    EXPECT_EQ(scene->free_way(at(64, 64, 5), kEast, 6), 6);
    EXPECT_EQ(scene->free_way(at(20, 64, 5), kUp, 50), 50);
}

TEST(OccluderScene, OfCoincidentSurfacesTheFrontCounts) {
    Surface sheet = test::ground(0, 0, 20, 20, 5);
    const size_t one_side = sheet.size();
    for (size_t i = 0; i < one_side; ++i) {
        const auto& [p, q, r] = sheet[i].corners;
        sheet.push_back({{p, r, q}});
    }
    for (int order = 0; order < 2; ++order) {
        const auto scene = OccluderScene::create(sheet, nullptr, kTile);
        ASSERT_TRUE(scene);
        EXPECT_EQ(scene->nearest_side(at(7, 9, 1), kUp), Side::kFront);
        EXPECT_EQ(scene->nearest_side(at(7, 9, 8), kDown), Side::kFront);
        std::reverse(sheet.begin(), sheet.end());
    }
}

// A slope of needles a few grid units wide, whose corners are rounded: rays that leave it upwards meet none of them.
TEST(OccluderScene, RaysLeaveASurfaceOfNeedlesFreely) {
    Surface surface;
    constexpr int64_t kWidth = 3;
    const auto place = [](int64_t i, int64_t length) {
        return GridPoint{i * kWidth, length,
                         std::llround(0.37 * static_cast<double>(i * kWidth) + 0.21 * static_cast<double>(length))};
    };
    const int64_t length = to_grid(60);
    for (int64_t i = 0; i < 2000; ++i) {
        surface.push_back({{place(i, 0), place(i + 1, 0), place(i + 1, length)}});
        surface.push_back({{place(i, 0), place(i + 1, length), place(i, length)}});
    }
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    const double size = std::sqrt(1 + 0.37 * 0.37 + 0.21 * 0.21);
    const std::array<double, 3> normal = {-0.37 / size, -0.21 / size, 1 / size};
    size_t cast = 0;
    for (int64_t i = 100; i < 1900; i += 36) {
        const GridPoint from = lifted(place(i, to_grid(30)), normal);
        for (const RayDirection& direction : cube_directions(8)) {
            const double rise = direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
            if (rise < 0.01) continue;
            ++cast;
            EXPECT_FALSE(blocked(*scene, from, direction)) << rise;
        }
    }
    EXPECT_GT(cast, 5000U);
}

TEST(OccluderScene, TrianglesCountWithinTheirReachAndHeightsBeyondIt) {
    const auto wall = test::tower(0, 64, 2, 40);
    const StartBox start = {at(100, 0, 0), at(300, 128, 10)};
    const OccluderReach reach = {.triangles = 128, .horizon = 200};
    const auto near_only = OccluderScene::create(wall, nullptr, start, reach);
    HeightGrid grid({-4, -4}, {30, 30});
    grid.add(wall);
    const auto with_heights = OccluderScene::create(wall, &grid, start, reach);
    ASSERT_TRUE(near_only && with_heights);
    constexpr RayDirection kWest = {-1, 0, 0};
    EXPECT_TRUE(blocked(*near_only, at(120, 64, 1), kWest));
    EXPECT_FALSE(blocked(*near_only, at(140, 64, 1), kWest));
    EXPECT_TRUE(blocked(*with_heights, at(140, 64, 1), kWest));
    EXPECT_FALSE(blocked(*with_heights, at(140, 64, 41), kWest));
    EXPECT_FALSE(blocked(*with_heights, at(220, 64, 1), kWest));
    // The tower is 2 m wide, its cells 16 m: beyond the reach of triangles one hides as much as the whole cell.
    EXPECT_FALSE(blocked(*with_heights, at(101, 70, 1), kWest));
    EXPECT_TRUE(blocked(*with_heights, at(150, 70, 1), kWest));
}

TEST(OccluderScene, ARayThatIsInsideOfACellWhereTheHorizonBeginsIsBlocked) {
    HeightGrid grid({0, 0}, {40, 8});
    grid.add(test::ground(0, 0, 640, 128, 20));
    const auto scene = OccluderScene::create({}, &grid, kTile, {.triangles = 128, .horizon = 1200});
    ASSERT_TRUE(scene);
    // Straight on and down, so that it never comes out through a top.
    EXPECT_TRUE(blocked(*scene, at(8, 64, 10), kEast));
    EXPECT_TRUE(blocked(*scene, at(8, 64, 10), ray_direction({100, 0, -3})));
    EXPECT_TRUE(blocked(*scene, at(8, 64, 30), ray_direction({100, 0, -12})));
    EXPECT_FALSE(blocked(*scene, at(8, 64, 30), kEast));
    EXPECT_FALSE(blocked(*scene, at(8, 64, 10), ray_direction({100, 0, 10})));
}

TEST(OccluderScene, AnswersDependNeitherOnTheOriginNorOnTheOrderOfTriangles) {
    Surface surface = test::city_tile(0, 0, true);
    test::add(surface, test::tiles_around(0, 0, true));
    HeightGrid grid({-20, -20}, {30, 30});
    grid.add(surface);
    const auto one = OccluderScene::create(surface, &grid, kTile);
    std::reverse(surface.begin(), surface.end());
    for (SurfaceTriangle& triangle : surface)
        std::rotate(triangle.corners.begin(), triangle.corners.begin() + 1, triangle.corners.end());
    StartBox moved = kTile;
    moved.low = at(-77.123, -31.777, -3.25);
    const auto other = OccluderScene::create(surface, &grid, moved);
    ASSERT_TRUE(one && other);
    const auto directions = cube_directions(32);
    for (int64_t i = 0; i < 40; ++i) {
        const GridPoint from = {(i * 7919) % kTile.high.x, (i * 104729) % kTile.high.y, 16 + i * 1000};
        EXPECT_EQ(all_blocked(*one, from, directions), all_blocked(*other, from, directions)) << i;
    }
}

TEST(OccluderScene, BundlesAndSingleRaysAgree) {
    Surface surface = test::city_tile(0, 0, true);
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    const auto directions = cube_directions(9);  // no multiple of a bundle
    ASSERT_NE(directions.size() % OccluderScene::kBundle, 0U);
    const GridPoint from = at(51.3, 51.1, 2);
    const auto together = all_blocked(*scene, from, directions);
    size_t hits = 0;
    for (size_t i = 0; i < directions.size(); ++i) {
        const bool hit = (together[i / 64] >> i % 64 & 1) != 0;
        EXPECT_EQ(hit, blocked(*scene, from, directions[i]));
        hits += hit ? 1 : 0;
    }
    EXPECT_GT(hits, 10U);
    EXPECT_LT(hits, directions.size());
}

TEST(Buried, TellsTheInsideAndTheUndergroundFromWhatIsSeen) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(64, 64, 16, 20, 0, -4));
    // A canopy: a sheet with its front up, 3 m above the ground beside the tower's west wall.
    test::add(surface, test::ground(46, 56, 56, 72, 3));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    const std::array<double, 3> up = {0, 0, 1}, west = {-1, 0, 0};
    EXPECT_FALSE(buried(*scene, at(20, 20, 0), up));
    EXPECT_TRUE(buried(*scene, at(64, 64, 0), up)) << "the ground under the tower";
    EXPECT_FALSE(buried(*scene, at(56, 64, 10), west));
    EXPECT_TRUE(buried(*scene, at(56, 64, -2), west)) << "the foot of the wall";
    EXPECT_FALSE(buried(*scene, at(56, 64, 1), west)) << "the wall below the canopy";
    EXPECT_FALSE(buried(*scene, at(64, 64, 20), up));
    EXPECT_TRUE(buried(*scene, at(56, 64, 0), west)) << "in the crease of wall and ground";
    const std::array<double, 3> down = {0, 0, -1};
    EXPECT_TRUE(buried(*scene, at(40, 40, 0), down)) << "a floor at the height of the ground";
    EXPECT_TRUE(enclosed(*scene, at(40, 40, 0), down));
    EXPECT_FALSE(buried(*scene, at(40, 40, 3), down)) << "the underside of something above the ground";
    EXPECT_TRUE(enclosed(*scene, at(64, 64, 0), up));
    EXPECT_TRUE(enclosed(*scene, at(56, 64, -2), west)) << "the foot of the wall";
    EXPECT_FALSE(enclosed(*scene, at(56, 64, 1), west)) << "the wall below the canopy";
    EXPECT_FALSE(enclosed(*scene, at(20, 20, 0), up));
}

TEST(Buried, FoundationsThatShowEachOtherTheirFrontsAreUnderTheGround) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(40, 64, 16, 20, 0, -12));
    test::add(surface, test::tower(58, 64, 16, 20, 0, -12));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    const std::array<double, 3> east = {1, 0, 0};
    for (const double depth : {0.5, 2.0, 4.0}) {
        EXPECT_TRUE(buried(*scene, at(48, 64, -depth), east)) << depth;
        EXPECT_TRUE(enclosed(*scene, at(48, 64, -depth), east)) << depth;
    }
    for (const double height : {0.1, 1.0, 8.0}) EXPECT_FALSE(buried(*scene, at(48, 64, height), east)) << height;
}

TEST(Buried, WhatIsBelowABridgeWithoutGroundIsNotEnclosed) {
    // A deck of one sheet, 12 m wide, and a pillar below it; the ground ends before.
    Surface surface = test::ground(0, 0, 20, 128);
    test::add(surface, test::ground(20, 58, 120, 70, 8));
    test::add(surface, test::tower(70, 64, 2, 8, 0, -2));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    for (const double height : {-1.0, 0.0, 4.0}) {
        EXPECT_FALSE(enclosed(*scene, at(70, 65, height), {0, 1, 0})) << height;
        EXPECT_FALSE(enclosed(*scene, at(71, 64, height), {1, 0, 0})) << height;
    }
}

}  // namespace
}  // namespace citystream::tiles::radiance
