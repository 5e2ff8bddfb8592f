#include "codec/mesh/depth_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "codec/mesh/triangle_crossing.h"
#include "codec/mesh/triangle_tree.h"

namespace citystream::codec::mesh {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

TEST(TriangleCrossing, KnowsCrossingTouchingCoplanarAndDistantPairs) {
    const GridTriangle base = {{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}};
    const auto with_base = [&](const GridTriangle& other) {
        bool same = true;
        for (size_t turn = 0; turn < 3; ++turn) {
            const GridTriangle turned = {other[turn], other[(turn + 2) % 3], other[(turn + 1) % 3]};
            same &= triangles_meet(base, turned) == triangles_meet(base, other);
            same &= triangles_meet(turned, base) == triangles_meet(base, other);
        }
        EXPECT_TRUE(same);
        return triangles_meet(base, other);
    };
    EXPECT_TRUE(with_base({{{2, 2, -5}, {2, 2, 5}, {30, 30, 5}}}));         // an edge through the inside
    EXPECT_FALSE(with_base({{{2, 2, 1}, {2, 2, 5}, {30, 30, 5}}}));         // above
    EXPECT_TRUE(with_base({{{2, 2, 0}, {2, 2, 5}, {30, 30, 5}}}));          // a corner on it
    EXPECT_FALSE(with_base({{{9, 9, -5}, {9, 9, 5}, {30, 30, 5}}}));        // through its plane, beside it
    EXPECT_TRUE(with_base({{{10, 0, 0}, {20, 0, 7}, {20, 5, -7}}}));        // corner to corner
    EXPECT_TRUE(with_base({{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}}));            // coplanar, within
    EXPECT_TRUE(with_base({{{-50, -50, 0}, {90, -50, 0}, {-50, 90, 0}}}));  // coplanar, around
    EXPECT_FALSE(with_base({{{11, 0, 0}, {20, 0, 0}, {20, 9, 0}}}));        // coplanar, beside
    EXPECT_TRUE(with_base({{{10, 0, 0}, {0, 10, 0}, {10, 10, 0}}}));        // coplanar, one edge in common
    EXPECT_TRUE(with_base({{{-5, 5, -3}, {20, 5, -3}, {5, 5, 40}}}));       // around it
    EXPECT_FALSE(with_base({{{2, 2, -5}, {2, 2, 5}, {2, 2, 9}}}));          // no area
    EXPECT_FALSE(has_area({{{2, 2, -5}, {2, 2, 5}, {2, 2, 9}}}));
}

TEST(TriangleCrossing, IsExactAtTheEndsOfTheGrid) {
    constexpr int32_t kEnd = (1 << 30) - 1;
    const GridTriangle base = {{{-kEnd, -kEnd, 0}, {kEnd, -kEnd, 1}, {-kEnd, kEnd, 1}}};
    // The plane passes through z = 1 along the line between the last two corners, a unit steps off it.
    EXPECT_TRUE(triangles_meet(base, {{{0, 0, 1}, {5, 5, 9}, {5, 6, 9}}}));
    EXPECT_FALSE(triangles_meet(base, {{{-1, 0, 1}, {-6, 5, 9}, {-6, 6, 9}}}));
    EXPECT_TRUE(triangles_meet(base, {{{-1, 0, 0}, {-6, 5, 9}, {-6, 6, 9}}}));
}

struct Scene {
    std::vector<GridPoint> points;
    Triangles triangles;
    std::vector<uint32_t> object;
};

Scene random_scene(uint64_t seed, int count, int32_t space, int32_t size) {
    std::mt19937_64 random(seed);
    Scene scene;
    for (int t = 0; t < count; ++t) {
        std::array<uint32_t, 3> triangle{};
        GridPoint at{};
        for (int32_t& x : at) x = static_cast<int32_t>(random() % static_cast<uint64_t>(space));
        for (uint32_t& v : triangle) {
            v = static_cast<uint32_t>(scene.points.size());
            GridPoint point = at;
            for (int32_t& x : point) x += static_cast<int32_t>(random() % static_cast<uint64_t>(size));
            scene.points.push_back(point);
        }
        scene.triangles.push_back(triangle);
        scene.object.push_back(static_cast<uint32_t>(t));
    }
    return scene;
}

TEST(TriangleTree, FindsEveryPairOfMeetingBoxesOnceAfterTheTrianglesMoved) {
    std::mt19937_64 random(1);
    for (const int count : {0, 1, 2, 5, 400}) {
        Scene scene = random_scene(2, count, 3000, 600);
        TriangleTree tree(scene.points, scene.triangles);
        for (GridPoint& point : scene.points)
            for (int32_t& x : point) x += static_cast<int32_t>(random() % 500);
        tree.refit(scene.points);
        std::vector<std::array<uint32_t, 2>> found, expected;
        tree.each_pair([&](uint32_t a, uint32_t b) { found.push_back({a, b}); });
        for (uint32_t a = 0; a < scene.triangles.size(); ++a) {
            for (uint32_t b = a + 1; b < scene.triangles.size(); ++b) {
                bool meet = true;
                for (size_t c = 0; c < 3; ++c) {
                    const auto span_of = [&](uint32_t t) {
                        const auto [i, j, k] = scene.triangles[t];
                        return std::minmax({scene.points[i][c], scene.points[j][c], scene.points[k][c]});
                    };
                    meet &= span_of(a).first <= span_of(b).second && span_of(b).first <= span_of(a).second;
                }
                if (meet) expected.push_back({a, b});
            }
        }
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected);
    }
}

/// A plate with a small letter 30 units above it, both of several triangles, tilted, so that cutting moves them apart.
Scene plate_with_letter() {
    Scene scene;
    const auto add = [&](const GridPoint& at, int32_t size, int32_t lift, uint32_t object) {
        const auto first = static_cast<uint32_t>(scene.points.size());
        for (int32_t y = 0; y < 3; ++y) {
            for (int32_t x = 0; x < 3; ++x)
                scene.points.push_back({at[0] + x * size, at[1] + y * size, at[2] + (x * size) / 7 + lift});
        }
        for (uint32_t y = 0; y < 2; ++y) {
            for (uint32_t x = 0; x < 2; ++x) {
                const uint32_t a = first + 3 * y + x;
                scene.triangles.push_back({a, a + 1, a + 4});
                scene.triangles.push_back({a, a + 4, a + 3});
                scene.object.insert(scene.object.end(), {object, object});
            }
        }
    };
    add({0, 0, 1000}, 7000, 0, 0);
    add({3500, 3300, 1000 + 3500 / 7}, 1001, 30, 1);
    add({40000, 40000, 0}, 3000, 0, 2);  // far from both
    return scene;
}

TEST(DepthOrder, ALetterOnAPlateNeverRunsIntoItAndWhatIsFarAwayIsFree) {
    const Scene scene = plate_with_letter();
    for (const Reconstruction reading : {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds}) {
        const PrecisionGrid grid = grid_of(scene.points, 12, reading);
        const auto most = depth_order_dropped(scene.points, scene.triangles, scene.object, grid);
        size_t met_without = 0;
        for (uint32_t level = 0; level <= 12; ++level) {
            std::vector<uint32_t> dropped(scene.points.size(), level);
            met_without += new_meetings(scene.points, scene.triangles, scene.object, grid, dropped).size();
            for (size_t v = 0; v < most.size(); ++v) dropped[v] = std::min(level, most[v]);
            EXPECT_TRUE(new_meetings(scene.points, scene.triangles, scene.object, grid, dropped).empty()) << level;
        }
        EXPECT_GT(met_without, 0u) << "the scene does not need the constraint";
        EXPECT_LT(most[9], 12u);
        for (size_t v = 18; v < 27; ++v) EXPECT_EQ(most[v], 12u);
    }
}

TEST(DepthOrder, CrowdedTrianglesKeepTheirOrderAtEveryLevelAndTheResultIsTheSameEveryTime) {
    const Scene scene = random_scene(3, 250, 40000, 3000);
    const PrecisionGrid grid = grid_of(scene.points, 11, Reconstruction::kThirds);
    const auto most = depth_order_dropped(scene.points, scene.triangles, scene.object, grid);
    EXPECT_EQ(most, depth_order_dropped(scene.points, scene.triangles, scene.object, grid));
    EXPECT_GT(std::set<uint32_t>(most.begin(), most.end()).size(), 3u);
    for (uint32_t level = 1; level <= 11; ++level) {
        std::vector<uint32_t> dropped;
        for (const uint32_t m : most) dropped.push_back(std::min(level, m));
        ASSERT_TRUE(new_meetings(scene.points, scene.triangles, scene.object, grid, dropped).empty()) << level;
    }
}

TEST(DepthOrder, TrianglesThatMeetFromTheStartAndTrianglesOfOneObjectAreLeftAlone) {
    Scene scene = random_scene(4, 60, 2000, 1500);
    const PrecisionGrid grid = grid_of(scene.points, 8, Reconstruction::kLow);
    std::fill(scene.object.begin(), scene.object.end(), 7u);
    const auto most = depth_order_dropped(scene.points, scene.triangles, scene.object, grid);
    EXPECT_EQ(most, std::vector<uint32_t>(scene.points.size(), 8));
}

TEST(DepthOrder, DuplicatesOfAPointAgree) {
    Scene scene = plate_with_letter();
    // The letter again as triangles with corners of their own.
    const size_t count = scene.triangles.size();
    for (size_t t = 8; t < 16; ++t) {
        std::array<uint32_t, 3> triangle{};
        for (size_t c = 0; c < 3; ++c) {
            triangle[c] = static_cast<uint32_t>(scene.points.size());
            scene.points.push_back(scene.points[scene.triangles[t][c]]);
        }
        scene.triangles.push_back(triangle);
        scene.object.push_back(1);
    }
    const PrecisionGrid grid = grid_of(scene.points, 12, Reconstruction::kThirds);
    const auto most = depth_order_dropped(scene.points, scene.triangles, scene.object, grid);
    for (size_t t = count; t < scene.triangles.size(); ++t) {
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(most[scene.triangles[t][c]], most[scene.triangles[t - count + 8][c]]);
    }
}

TEST(DepthOrder, NothingAtAllIsFine) {
    EXPECT_TRUE(depth_order_dropped({}, {}, {}, grid_of({}, 4, Reconstruction::kLow)).empty());
}

}  // namespace
}  // namespace citystream::codec::mesh
