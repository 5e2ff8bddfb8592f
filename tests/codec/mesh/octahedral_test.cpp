#include "codec/mesh/octahedral.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

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

/// Of the 16-bit codes of a list of vectors (FNV-1a).
uint64_t hash_of_codes(const std::vector<std::array<float, 3>>& vectors) {
    uint64_t hash = 14695981039346656037U;
    for (const auto& vector : vectors) {
        const uint32_t code = pack_octahedral16(vector.data());
        for (const uint32_t byte : {code & 255U, code >> 8}) hash = (hash ^ byte) * 1099511628211U;
    }
    return hash;
}

TEST(Octahedral, SixteenBitCodesAreThoseThatStoredLayersHold) {
    std::vector<std::array<float, 3>> vectors;  // among them many that lie halfway between lattice points
    for (int x = -20; x <= 20; ++x) {
        for (int y = -20; y <= 20; ++y) {
            for (int z = -20; z <= 20; ++z)
                vectors.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
        }
    }
    EXPECT_EQ(hash_of_codes(vectors), 0x3d8e0b5ce07995dfU);
}

constexpr uint32_t kAllBits[] = {2, 3, 4, 7, 8, 12, 15, 16, 17, 20, 23, 24, 25, 26, 31, 32};

/// Half of them near the worst directions, where |x| = |y| = |z|.
std::vector<Direction> sample_directions(size_t count) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> gauss;
    std::vector<Direction> directions;
    for (size_t i = 0; i < count; ++i) {
        Direction n = {gauss(random), gauss(random), gauss(random)};
        if (i % 2 == 1) {
            for (double& c : n) c = std::copysign(1.0, c) + 0.02 * gauss(random);
        }
        directions.push_back(n);
    }
    return directions;
}

TEST(Octahedral, EveryBudgetKeepsTheTheoreticalBound) {
    const std::vector<Direction> directions = sample_directions(100000);
    for (const uint32_t bits : kAllBits) {
        if (bits < 7) continue;  // the bound is of first order in the step
        const double bound = std::numbers::sqrt2 * 2 / (2.0 * octahedral_side(bits));
        double worst = 0;
        for (const Direction& n : directions)
            worst = std::max(worst, angle_between(unpack_octahedral(pack_octahedral(n, bits), bits), n));
        EXPECT_LT(worst, bound * 1.005) << bits;
        EXPECT_GT(worst, bound * 0.95) << bits;
    }
}

TEST(Octahedral, EveryBudgetDecodesAxesExactly) {
    for (const uint32_t bits : kAllBits) {
        for (size_t axis = 0; axis < 3; ++axis) {
            for (const double sign : {1.0, -1.0}) {
                Direction normal = {0, -0.0, 0};
                normal[axis] = 3 * sign;
                const std::array<int32_t, 3> back = unfold_octahedral(pack_octahedral(normal, bits), bits);
                for (size_t c = 0; c < 3; ++c)
                    EXPECT_EQ(back[c], c == axis ? sign * octahedral_side(bits) : 0) << bits << " bits, axis " << axis;
            }
        }
    }
}

TEST(Octahedral, CodesOfEveryBudgetAreDirectionsThatPackToThemselves) {
    std::mt19937_64 random(13);
    for (const uint32_t bits : kAllBits) {
        for (int i = 0; i < 20000; ++i) {
            uint64_t code = random();  // bits above the code's, and the value that is never written, too
            if (i % 4 == 0) code |= (uint64_t{1} << bits) - 1;
            if (i % 4 == 1) code &= ~((uint64_t{1} << bits) - 1);
            const std::array<int32_t, 3> d = unfold_octahedral(code, bits);
            ASSERT_EQ(int64_t{std::abs(d[0])} + std::abs(d[1]) + std::abs(d[2]), octahedral_side(bits));
            const uint64_t again = pack_octahedral(unpack_octahedral(code, bits), bits);
            ASSERT_EQ(unfold_octahedral(again, bits), d) << bits << " bits, code " << code;
        }
    }
}

TEST(Octahedral, DecodingInFloatsAddsTheirRoundingAndNoMore) {
    constexpr double kFloatUnitVector = 5.1e-8;
    const std::vector<Direction> directions = sample_directions(100000);
    for (const uint32_t bits : {8U, 16U, 20U, 23U, 24U, 25U, 26U, 32U}) {
        double worst = 0;
        for (const Direction& n : directions) {
            const std::array<float, 3> unit = unpack_octahedral_float(pack_octahedral(n, bits), bits);
            const volatile float x = unit[0], y = unit[1], z = unit[2];  // no wider than floats
            worst = std::max(worst, angle_between({x, y, z}, n));
        }
        const double bound = std::numbers::sqrt2 * 2 / (2.0 * octahedral_side(bits));
        EXPECT_LT(worst, bits <= 25 ? bound + kFloatUnitVector : 1.2e-7) << bits;
    }
}

TEST(Octahedral, VectorsOfAnyLengthHaveTheSameCode) {
    for (const double length : {5e-324, 1e-310, 1e-30, 1e30, 1e308}) {
        const Direction n = {length, -length, 0};
        EXPECT_EQ(pack_octahedral(n, 16), pack_octahedral({1, -1, 0}, 16)) << length;
    }
    const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (const Direction& none :
         {Direction{0, 0, 0}, Direction{-0.0, 0, -0.0}, Direction{nan, 1, 1}, Direction{0, -infinity, 0}}) {
        EXPECT_EQ(unpack_octahedral(pack_octahedral(none, 16), 16), (Direction{0, 0, 1}));
    }
}

TEST(Octahedral, TheLowerPoleIsOneDirectionAtAllFourCorners) {
    for (const uint32_t bits : kAllBits) {
        const auto last = static_cast<uint64_t>(2) * static_cast<uint64_t>(octahedral_side(bits));
        for (const uint64_t code : {uint64_t{0}, last, last << bits, last | last << bits})
            EXPECT_EQ(unfold_octahedral(code, bits), (std::array<int32_t, 3>{0, 0, -octahedral_side(bits)})) << bits;
    }
}

TEST(Octahedral, TheSeamAndZerosOfTheLowerHalfFoldToTheSideOfPlus) {
    // On the seam |u| + |v| = S both formulas give the same vector.
    for (int32_t u = -127; u <= 127; ++u) {
        for (const int32_t v : {127 - std::abs(u), std::abs(u) - 127}) {
            const auto code = static_cast<uint64_t>(u + 127) | static_cast<uint64_t>(v + 127) << 8;
            EXPECT_EQ(unfold_octahedral(code, 8), (std::array<int32_t, 3>{u, v, 0}));
        }
    }
    for (const double zero : {0.0, -0.0}) {
        const uint64_t code = pack_octahedral({zero, 0.6, -0.8}, 16);
        EXPECT_LT(angle_between(unpack_octahedral(code, 16), {0, 0.6, -0.8}), 2e-5);
        EXPECT_GE(code & 0xffff, 32767U) << "sg(+-0) = +1";
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
