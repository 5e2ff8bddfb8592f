#include "codec/mesh/octahedral_residual.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <set>

#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {
namespace {

uint64_t code_at(int64_t u, int64_t v, uint32_t bits) {
    const int64_t side = octahedral_side(bits);
    return static_cast<uint64_t>(u + side) | static_cast<uint64_t>(v + side) << bits;
}

TEST(OctahedralResidual, CanonicalCodesStandForTheSameDirectionsOnceEach) {
    for (const uint32_t bits : {2U, 3U, 8U}) {
        const int64_t side = octahedral_side(bits);
        std::set<std::array<int32_t, 3>> directions;
        std::set<uint64_t> codes;
        for (int64_t u = -side; u <= side; ++u) {
            for (int64_t v = -side; v <= side; ++v) {
                const uint64_t code = code_at(u, v, bits), canonical = canonical_octahedral(code, bits);
                ASSERT_EQ(unfold_octahedral(canonical, bits), unfold_octahedral(code, bits));
                ASSERT_EQ(canonical_octahedral(canonical, bits), canonical);
                directions.insert(unfold_octahedral(code, bits));
                codes.insert(canonical);
            }
        }
        // A lattice on the octahedron of S steps an edge.
        EXPECT_EQ(codes.size(), static_cast<size_t>(4 * side * side + 2));
        EXPECT_EQ(directions.size(), codes.size());
    }
}

TEST(OctahedralResidual, EveryPairOfSmallCodesComesBack) {
    constexpr uint32_t kBits = 4;
    for (uint64_t predicted = 0; predicted < 256; ++predicted) {
        for (uint64_t actual = 0; actual < 256; ++actual) {
            const auto residual = octahedral_residual(actual, predicted, kBits);
            ASSERT_LE(std::abs(residual[0]), octahedral_side(kBits));
            ASSERT_LE(std::abs(residual[1]), octahedral_side(kBits));
            ASSERT_EQ(octahedral_of_residual(residual, predicted, kBits), canonical_octahedral(actual, kBits));
        }
    }
}

TEST(OctahedralResidual, AnyNumbersOfAnyBudgetAreCodesThatComeBack) {
    std::mt19937_64 random(3);
    for (const uint32_t bits : {2U, 8U, 12U, 16U, 24U, 31U, 32U}) {
        for (int i = 0; i < 20000; ++i) {
            const uint64_t actual = random(), predicted = random();
            const auto residual = octahedral_residual(actual, predicted, bits);
            ASSERT_EQ(octahedral_of_residual(residual, predicted, bits), canonical_octahedral(actual, bits)) << bits;
            const std::array<int32_t, 2> wild = {static_cast<int32_t>(random()), static_cast<int32_t>(random())};
            const uint64_t code = octahedral_of_residual(wild, predicted, bits);
            ASSERT_EQ(canonical_octahedral(code, bits), code);
        }
    }
}

TEST(OctahedralResidual, NeighboursDifferByLittleAcrossEveryFold) {
    constexpr uint32_t kBits = 8;
    std::mt19937_64 random(5);
    std::normal_distribution<double> gauss;
    int64_t farthest = 0;
    for (int i = 0; i < 200000; ++i) {
        Direction n = {gauss(random), gauss(random), gauss(random)};
        if (i % 4 == 1) n[0] *= 1e-3;  // near the planes where the lower half is folded
        if (i % 4 == 2) n[2] *= 1e-3;  // near the seam
        if (i % 4 == 3) n = {1e-3 * n[0], 1e-3 * n[1], -1};
        n = unit_direction(n);
        Direction m = n;
        for (double& c : m) c += 0.002 * gauss(random);
        const auto residual = octahedral_residual(pack_octahedral(m, kBits), pack_octahedral(n, kBits), kBits);
        farthest = std::max<int64_t>({farthest, std::abs(residual[0]), std::abs(residual[1])});
    }
    // Five times the deviation, stretched by 3 and by the lattice's 127 steps: 4, and one step for rounding.
    EXPECT_LE(farthest, 5);
    EXPECT_EQ(octahedral_residual(pack_octahedral({0, 1e-4, -1}, kBits), pack_octahedral({0, -1e-4, -1}, kBits), kBits),
              (std::array<int32_t, 2>{0, 0}));
}

}  // namespace
}  // namespace citystream::codec::mesh
