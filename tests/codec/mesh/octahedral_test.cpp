#include "codec/mesh/octahedral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>

namespace citystream::codec::mesh {
namespace {

double angle_to_code(uint32_t packed, const double n[3]) {
    int32_t d[3];
    unfold_octahedral16(packed, d);
    const double cross[3] = {d[1] * n[2] - d[2] * n[1], d[2] * n[0] - d[0] * n[2], d[0] * n[1] - d[1] * n[0]};
    const double dot = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    return std::atan2(std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]), dot);
}

TEST(Octahedral, EveryCodeUnfoldsOntoTheOctahedron) {
    for (uint32_t packed = 0; packed < 65536; ++packed) {
        int32_t d[3];
        unfold_octahedral16(packed, d);
        ASSERT_EQ(std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]), 127) << packed;
    }
}

TEST(Octahedral, AxesDecodeExactly) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            float normal[3] = {0, -0.0f, 0};
            normal[axis] = sign;
            float back[3];
            unpack_octahedral16(pack_octahedral16(normal), back);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(back[c], normal[c]) << "axis " << axis;
        }
    }
}

TEST(Octahedral, CodesOfDecodedDirectionsStandForTheSameDirection) {
    for (uint32_t v = 0; v < 255; ++v) {
        for (uint32_t u = 0; u < 255; ++u) {
            int32_t direction[3];
            unfold_octahedral16(u | v << 8, direction);
            float normal[3];
            unpack_octahedral16(u | v << 8, normal);
            int32_t again[3];
            unfold_octahedral16(pack_octahedral16(normal), again);
            // The rim of the square is folded: two codes there can be one direction.
            for (int c = 0; c < 3; ++c) ASSERT_EQ(again[c], direction[c]) << "u " << u << " v " << v;
        }
    }
}

TEST(Octahedral, LargestErrorIsTheTheoreticalBoundOfRangeQuantisation) {
    const double bound = std::numbers::sqrt2 * 2 / 254;
    std::mt19937_64 random(3);
    std::normal_distribution<double> gauss;
    double worst = 0;
    for (int i = 0; i < 400000; ++i) {
        double n[3] = {gauss(random), gauss(random), gauss(random)};
        if (i % 2 == 1) {
            // Half of the samples near the worst directions, where |x| = |y| = |z|.
            for (double& c : n) c = std::copysign(1.0, c) + 0.02 * gauss(random);
        }
        const float normal[3] = {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
        worst = std::max(worst, angle_to_code(pack_octahedral16(normal), n));
    }
    EXPECT_LT(worst, bound * 1.005);
    EXPECT_GT(worst, bound * 0.95);
}

TEST(Octahedral, PicksTheNearestOfTheEnclosingLatticePoints) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> gauss;
    for (int i = 0; i < 200; ++i) {
        const double n[3] = {gauss(random), gauss(random), gauss(random)};
        const float normal[3] = {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
        double nearest = 10;
        for (uint32_t v = 0; v < 255; ++v) {
            for (uint32_t u = 0; u < 255; ++u) nearest = std::min(nearest, angle_to_code(u | v << 8, n));
        }
        // A point outside the cell can be nearer by a hair, never by more than a tenth of the bound.
        EXPECT_LE(angle_to_code(pack_octahedral16(normal), n), nearest + 0.0011);
    }
}

TEST(Octahedral, AwkwardVectorsGiveFiniteUnitVectors) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const float vectors[][3] = {
        {0, 0, 0}, {nan, 0, 1}, {0, inf, 0}, {1e-45f, 0, 0}, {1e-30f, 1e-30f, -1e-30f}, {3e38f, -3e38f, 3e38f}};
    for (const auto& vector : vectors) {
        float back[3];
        unpack_octahedral16(pack_octahedral16(vector), back);
        EXPECT_NEAR(back[0] * back[0] + back[1] * back[1] + back[2] * back[2], 1.0f, 1e-6f);
    }
    float back[3];
    unpack_octahedral16(pack_octahedral16(vectors[3]), back);
    EXPECT_EQ(back[0], 1.0f) << "length does not matter";
    unpack_octahedral16(pack_octahedral16(vectors[1]), back);
    EXPECT_EQ(back[2], 1.0f) << "no direction means up";
}

}  // namespace
}  // namespace citystream::codec::mesh
