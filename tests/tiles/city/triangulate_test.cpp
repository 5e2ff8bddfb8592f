#include "tiles/city/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace citystream::tiles::city {
namespace {

double triangles_area(const std::vector<Corner>& corners, const std::vector<std::array<uint32_t, 3>>& triangles,
                      const Vec3& normal) {
    const double length = std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
    double area = 0;
    for (const auto& t : triangles) {
        const std::array<Corner, 3> ring = {corners[t[0]], corners[t[1]], corners[t[2]]};
        const Vec3 n = newell_normal(ring);
        area += (n.x * normal.x + n.y * normal.y + n.z * normal.z) / length / 2;  // negative when turned the wrong way
    }
    return area;
}

/// A point of the plane through `origin` with the texture coordinate that is
/// its plane coordinate.
Corner on_plane(double u, double v) {
    const Vec3 origin = {1000, 2000, 30};
    return {{origin.x + 0.6 * u - 0.48 * v, origin.y + 0.8 * u + 0.36 * v, origin.z + 0.8 * v}, {u, v}};
}

struct Split {
    std::vector<Corner> corners;
    std::vector<std::array<uint32_t, 3>> triangles;
    PolygonOutcome outcome;
    double area = 0;

    Split(std::vector<Corner> points, const std::vector<uint32_t>& ring_ends) : corners(std::move(points)) {
        Triangulator triangulator;
        outcome = triangulator.triangulate(corners, ring_ends, triangles);
        area = triangles_area(corners, triangles, outcome.normal);
    }
};

TEST(Triangulate, ConvexQuadrilateralGivesTwoTrianglesWithItsOrientation) {
    const Split split({on_plane(0, 0), on_plane(4, 0), on_plane(4, 3), on_plane(0, 3)}, {4});
    EXPECT_EQ(split.outcome.fault, PolygonFault::kNone);
    EXPECT_EQ(split.triangles.size(), 2u);
    EXPECT_NEAR(split.area, 12, 1e-9);
}

TEST(Triangulate, ConcavePolygonIsCoveredExactly) {
    const Split split({on_plane(0, 0), on_plane(4, 0), on_plane(4, 4), on_plane(2, 1), on_plane(0, 4)}, {5});
    EXPECT_EQ(split.triangles.size(), 3u);
    EXPECT_NEAR(split.area, 16 - 6, 1e-9);
    EXPECT_FALSE(split.outcome.crosses_itself);
}

TEST(Triangulate, HolesStayOpenWhicheverWayTheyRun) {
    const std::vector<Corner> outer = {on_plane(0, 0), on_plane(10, 0), on_plane(10, 10), on_plane(0, 10)};
    std::vector<Corner> one = outer, other = outer;
    for (const Corner& c : {on_plane(2, 2), on_plane(4, 2), on_plane(4, 4), on_plane(2, 4)}) one.push_back(c);
    for (const Corner& c : {on_plane(2, 4), on_plane(4, 4), on_plane(4, 2), on_plane(2, 2)}) other.push_back(c);
    for (const auto& points : {one, other}) {
        const Split split(points, {4, 8});
        EXPECT_EQ(split.triangles.size(), 8u);
        EXPECT_EQ(split.corners.size(), 8u);
        EXPECT_NEAR(split.area, 96, 1e-9);
    }
}

TEST(Triangulate, CrossingEdgesGetACornerWithInterpolatedTextureCoordinates) {
    const Split split({on_plane(0, 0), on_plane(4, 0), on_plane(4, 3), on_plane(1, -1), on_plane(0, 3)}, {5});
    EXPECT_TRUE(split.outcome.crosses_itself);
    ASSERT_GT(split.corners.size(), 5u);
    for (size_t i = 5; i < split.corners.size(); ++i) {
        const Vec2 uv = split.corners[i].texcoord;
        const Vec3 expected = on_plane(uv.x, uv.y).position;
        EXPECT_NEAR(split.corners[i].position.x, expected.x, 1e-4);
        EXPECT_NEAR(split.corners[i].position.z, expected.z, 1e-4);
    }
}

TEST(Triangulate, PointsOnOneLineAreDegenerate) {
    const Split split({on_plane(0, 0), on_plane(5, 5), on_plane(9, 9)}, {3});
    EXPECT_EQ(split.outcome.fault, PolygonFault::kDegenerate);
    EXPECT_TRUE(split.triangles.empty());
}

TEST(Triangulate, KeyholePolygonThatTouchesItselfIsNotCalledCrossing) {
    // A hole joined to the outline by a bridge walked twice.
    const Split split({on_plane(0, 0), on_plane(9, 0), on_plane(9, 9), on_plane(0, 9), on_plane(0, 0), on_plane(3, 3),
                       on_plane(3, 6), on_plane(6, 6), on_plane(6, 3), on_plane(3, 3)},
                      {10});
    EXPECT_EQ(split.outcome.fault, PolygonFault::kNone);
    EXPECT_FALSE(split.outcome.crosses_itself);
    EXPECT_NEAR(split.area, 81 - 9, 1e-9);
}

TEST(Triangulate, RandomStarsAreCoveredExactly) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> radius(0.5, 20);
    for (int round = 0; round < 200; ++round) {
        const uint32_t count = 5 + static_cast<uint32_t>(round);
        std::vector<Corner> points;
        double expected = 0;
        std::vector<Vec2> flat;
        for (uint32_t i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * i / count, r = radius(random);
            flat.push_back({r * std::cos(angle), r * std::sin(angle)});
            points.push_back(on_plane(flat.back().x, flat.back().y));
        }
        for (uint32_t i = 0; i < count; ++i) {
            const Vec2 &a = flat[i], &b = flat[(i + 1) % count];
            expected += (a.x * b.y - a.y * b.x) / 2;
        }
        const Split split(points, {count});
        ASSERT_EQ(split.triangles.size(), count - 2) << "star of " << count;
        ASSERT_NEAR(split.area, expected, 1e-7 * expected);
    }
}

TEST(Triangulate, RandomTanglesNeverBreakIt) {
    std::mt19937 random(11);
    std::uniform_int_distribution<int> coordinate(0, 12);  // a small grid: many touching and overlapping edges
    for (int round = 0; round < 3000; ++round) {
        std::vector<Corner> points;
        const uint32_t count = 3 + static_cast<uint32_t>(round % 40);
        for (uint32_t i = 0; i < count; ++i)
            points.push_back(on_plane(coordinate(random), coordinate(random) + 0.1 * i / count));
        const Split split(points, {count});
        for (const auto& t : split.triangles) {
            for (const uint32_t corner : t) ASSERT_LT(corner, split.corners.size());
        }
    }
}

TEST(Triangulate, HugeTangleIsRefusedQuickly) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> coordinate(0, 1000);
    std::vector<Corner> points;
    constexpr uint32_t kCount = 40000;
    for (uint32_t i = 0; i < kCount; ++i) points.push_back(on_plane(coordinate(random), coordinate(random)));
    const Split split(points, {kCount});
    EXPECT_EQ(split.outcome.fault, PolygonFault::kTangled);
}

TEST(Triangulate, OutlineOfSixThousandPointsIsSplit) {
    std::vector<Corner> points;
    constexpr uint32_t kCount = 6000;
    for (uint32_t i = 0; i < kCount; ++i) {
        const double angle = 2 * std::numbers::pi * i / kCount, r = 500 + 20 * (i % 2);
        points.push_back(on_plane(r * std::cos(angle), r * std::sin(angle)));
    }
    const Split split(points, {kCount});
    EXPECT_EQ(split.outcome.fault, PolygonFault::kNone);
    EXPECT_EQ(split.triangles.size(), kCount - 2);
}

}  // namespace
}  // namespace citystream::tiles::city
