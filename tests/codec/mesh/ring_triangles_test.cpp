#include "codec/mesh/ring_triangles.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

Triangles sorted(Triangles triangles) {
    for (auto& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}
Ring wheel(uint32_t n, std::mt19937& random) {
    Ring ring;
    for (uint32_t i = 0; i < n; ++i) {
        const double angle = 6.283185307179586 * i / n, radius = 5000 + static_cast<double>(random() % 5000);
        ring.points.push_back(
            {static_cast<int32_t>(radius * std::cos(angle)), static_cast<int32_t>(radius * std::sin(angle))});
    }
    return ring;
}
/// Some triangulation of a ring of n points, whatever it looks like.
Triangles random_triangles(uint32_t n, std::mt19937& random) {
    Triangles triangles;
    std::vector<std::pair<uint32_t, uint32_t>> open = {{0, n - 1}};
    while (!open.empty()) {
        const auto [a, b] = open.back();
        open.pop_back();
        if (b - a < 2) continue;
        const auto c = static_cast<uint32_t>(a + 1 + random() % (b - a - 1));
        triangles.push_back({a, c, b});
        open.insert(open.end(), {{a, c}, {c, b}});
    }
    return triangles;
}
Triangles round_trip(const std::vector<Ring>& rings, Triangles triangles, size_t& bytes) {
    bits::RangeEncoder encoder;
    RingTriangleModel writing, reading;
    writing.code(encoder, rings, triangles);
    const auto coded = encoder.finish();
    bytes = coded.size();
    bits::RangeDecoder decoder(coded);
    Triangles again;
    reading.code(decoder, rings, again);
    EXPECT_TRUE(decoder.finish().ok());
    return again;
}

TEST(RingTriangles, AnyTriangulationOfARingComesBack) {
    std::mt19937 random(1);
    for (const uint32_t n : {3u, 4u, 5u, 8u, 30u, 255u, 258u, 700u}) {
        const std::vector<Ring> rings = {wheel(n, random)};
        for (int round = 0; round < 5; ++round) {
            const Triangles triangles = random_triangles(n, random);
            ASSERT_TRUE(is_ring_triangulation(rings, triangles));
            size_t bytes = 0;
            EXPECT_EQ(sorted(round_trip(rings, triangles, bytes)), sorted(triangles));
        }
    }
}

TEST(RingTriangles, WhatATessellatorMakesCostsNextToNothing) {
    std::mt19937 random(2);
    const std::vector<Ring> rings = {wheel(200, random), courtyard(-900, -900, 500, 500),
                                     courtyard(100, 100, 500, 500)};
    const Triangles triangles = sweep_triangles(rings);
    ASSERT_TRUE(is_ring_triangulation(rings, triangles));
    size_t bytes = 0;
    EXPECT_EQ(sorted(round_trip(rings, triangles, bytes)), sorted(triangles));
    EXPECT_LE(bytes, 3u);
}

TEST(RingTriangles, HolesMayBeJoinedAnyhow) {
    // Not as the sweep would: both holes hang on far corners.
    const std::vector<Ring> rings = {rectangle(0, 0, 30, 30), courtyard(10, 10, 10, 10)};
    const Triangles other = {{0, 1, 4}, {1, 7, 4}, {1, 2, 7}, {2, 6, 7}, {2, 3, 6}, {3, 5, 6}, {3, 0, 5}, {0, 4, 5}};
    ASSERT_TRUE(is_ring_triangulation(rings, other));
    size_t bytes = 0;
    EXPECT_EQ(sorted(round_trip(rings, other, bytes)), sorted(other));
}

TEST(RingTriangles, WhatIsNotOneDiscWithHolesIsRefused) {
    const std::vector<Ring> square = {rectangle(0, 0, 9, 9)};
    EXPECT_TRUE(is_ring_triangulation(square, Triangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_FALSE(is_ring_triangulation(square, Triangles{{0, 1, 2}}));
    EXPECT_FALSE(is_ring_triangulation(square, Triangles{{0, 1, 2}, {0, 1, 2}}));
    EXPECT_FALSE(is_ring_triangulation(square, Triangles{{0, 2, 1}, {0, 3, 2}}));
    EXPECT_FALSE(is_ring_triangulation(square, Triangles{{0, 1, 2}, {2, 3, 1}}));
    EXPECT_FALSE(is_ring_triangulation(std::vector<Ring>{{{{0, 0}, {4, 4}}}}, Triangles{}));
}

TEST(SweepTriangles, CoverAPolygonWithHolesExactly) {
    std::mt19937 random(3);
    for (const uint32_t n : {3u, 4u, 7u, 50u, 400u}) {
        for (const bool holes : {false, true}) {
            std::vector<Ring> rings = {wheel(n < 7 ? n + 10 : n, random)};
            if (holes) rings.insert(rings.end(), {courtyard(-900, -900, 500, 500), courtyard(100, 150, 500, 500)});
            std::vector<std::array<int32_t, 2>> points;
            int64_t expected = 0, found = 0;
            for (const Ring& ring : rings) {
                for (size_t i = 0; i < ring.points.size(); ++i) {
                    const auto &p = ring.points[i], &q = ring.points[(i + 1) % ring.points.size()];
                    expected += int64_t{p[0]} * q[1] - int64_t{p[1]} * q[0];
                    points.push_back(p);
                }
            }
            const Triangles triangles = sweep_triangles(rings);
            EXPECT_EQ(triangles.size(), points.size() + 2 * rings.size() - 4);
            for (const auto& t : triangles) {
                const auto &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
                const int64_t area = (int64_t{b[0]} - a[0]) * (c[1] - a[1]) - (int64_t{b[1]} - a[1]) * (c[0] - a[0]);
                EXPECT_GE(area, 0);
                found += area;
            }
            EXPECT_EQ(found, expected);
        }
    }
}

TEST(SweepTriangles, AnythingIsAnsweredForAnyRings) {
    std::mt19937 random(4);
    for (int round = 0; round < 300; ++round) {
        std::vector<Ring> rings;
        size_t points = 0;
        for (auto r = 1 + random() % 3; r > 0; --r) {
            Ring& ring = rings.emplace_back();
            for (auto n = 3 + random() % 12; n > 0; --n, ++points)
                ring.points.push_back({static_cast<int32_t>(random() % 5), static_cast<int32_t>(random() % 5)});
        }
        for (const auto& t : sweep_triangles(rings))
            for (const uint32_t corner : t) EXPECT_LT(corner, points);
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
