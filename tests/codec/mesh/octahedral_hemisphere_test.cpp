#include "codec/mesh/octahedral_hemisphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kAllBits[] = {2, 3, 7, 8, 15, 16, 24, 25, 31, 32};

double bound_of(uint32_t bits) {
    return std::sqrt(6.0) / 2 * 2 / (2.0 * octahedral_side(bits));
}

TEST(OctahedralHemisphere, LargestErrorIsTheTheoreticalBound) {
    for (const uint32_t bits : {8U, 12U, 16U, 24U, 31U}) {
        std::mt19937_64 random(3);
        std::normal_distribution<double> gauss;
        double worst = 0;
        for (int i = 0; i < 100000; ++i) {
            Direction n = {gauss(random), gauss(random), std::abs(gauss(random))};
            if (i % 2 == 1) {
                for (double& c : n) c = std::copysign(1.0, c) + 0.02 * gauss(random);
            }
            worst = std::max(worst, angle_between(unpack_hemisphere(pack_hemisphere(n, bits), bits), n));
        }
        EXPECT_LT(worst, bound_of(bits) * 1.005) << bits;
        EXPECT_GT(worst, bound_of(bits) * 0.95) << bits;
    }
}

TEST(OctahedralHemisphere, TheFlatNormalAndTheRimsAxesAreExact) {
    for (const uint32_t bits : kAllBits) {
        const int64_t side = octahedral_side(bits);
        EXPECT_EQ(unfold_hemisphere(pack_hemisphere({0, 0, 2}, bits), bits), (std::array<int64_t, 3>{0, 0, 2 * side}));
        EXPECT_EQ(unfold_hemisphere(pack_hemisphere({3, 0, 0}, bits), bits), (std::array<int64_t, 3>{2 * side, 0, 0}));
        EXPECT_EQ(unfold_hemisphere(pack_hemisphere({0, -1, -0.0}, bits), bits),
                  (std::array<int64_t, 3>{0, -2 * side, 0}));
        EXPECT_EQ(unfold_hemisphere(pack_hemisphere({1, 1, 0}, bits), bits), (std::array<int64_t, 3>{side, side, 0}));
    }
}

TEST(OctahedralHemisphere, CodesAreDirectionsAboveThePlaneThatPackToThemselves) {
    std::mt19937_64 random(5);
    for (const uint32_t bits : kAllBits) {
        for (int i = 0; i < 20000; ++i) {
            const uint64_t code = i % 4 == 0 ? random() | ((uint64_t{1} << bits) - 1) : random();
            const std::array<int64_t, 3> d = unfold_hemisphere(code, bits);
            ASSERT_GE(d[2], 0);
            ASSERT_EQ(std::abs(d[0]) + std::abs(d[1]) + d[2], int64_t{2} * octahedral_side(bits));
            const uint64_t again = pack_hemisphere(unpack_hemisphere(code, bits), bits);
            ASSERT_EQ(unfold_hemisphere(again, bits), d) << bits << " bits, code " << code;
        }
    }
}

TEST(OctahedralHemisphere, VectorsBelowThePlaneAreMovedOntoIt) {
    EXPECT_EQ(pack_hemisphere({0.6, 0.3, -0.8}, 16), pack_hemisphere({0.6, 0.3, 0}, 16));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Direction& none : {Direction{0, 0, 0}, Direction{0, 0, -1}, Direction{nan, 0, 0}})
        EXPECT_EQ(unpack_hemisphere(pack_hemisphere(none, 16), 16), (Direction{0, 0, 1}));
}

}  // namespace
}  // namespace citystream::codec::mesh
