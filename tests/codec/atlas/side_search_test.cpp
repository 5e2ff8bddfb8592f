// One side's search: the least accepted size, found by few errors.
#include "codec/atlas/side_search.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::codec::atlas {
namespace {

TEST(SideSearch, EnclosesTheLeastAcceptedSizeOfSmoothErrorsInFewSteps) {
    for (const double power : {0.3, 1.0, 3.0}) {
        for (const uint32_t full : {40u, 400u, 8192u}) {
            for (const double share : {0.01, 0.1, 0.5, 0.9}) {
                const Sizes sizes{full, 1};
                const auto error = [&](uint32_t size) { return std::pow(std::log2(double(full) / size), power); };
                const double limit = error(std::max(1u, static_cast<uint32_t>(share * full)));
                SideSearch side(sizes, limit);
                int steps = 0;
                uint32_t least_accepted = full;
                while (const auto at = side.next()) {
                    ASSERT_LT(++steps, 14) << power << ' ' << full << ' ' << share;
                    ASSERT_TRUE(*at >= side.least() && *at < least_accepted);
                    side.note(*at, error(*at));
                    if (error(*at) <= limit) least_accepted = *at;
                }
                EXPECT_LE(error(least_accepted), limit);
                EXPECT_LE(least_accepted - side.least(), least_accepted / 32) << "known to a part of its size";
            }
        }
    }
}

TEST(SideSearch, ErrorsBetweenMeasuredOnesLieBetweenThem) {
    SideSearch side({64, 4}, 0.1);
    EXPECT_TRUE(std::isinf(side.error(3)));
    EXPECT_EQ(side.error(16), 0);
    side.note(8, 0.05);
    side.note(2, 0.3);
    EXPECT_EQ(side.error(8), 0.05);
    EXPECT_NEAR(side.error(4), 0.175, 1e-6) << "half way in the logarithm";
    EXPECT_NEAR(side.error(1), 0.425, 1e-6) << "continued below";
    EXPECT_EQ(side.least(), 3);
}

TEST(SideSearch, ErrorsWithoutAnyOrderStillEnd) {
    for (uint32_t seed = 1; seed < 200; ++seed) {
        uint32_t state = seed;
        SideSearch side({1 + seed * 37 % 3000, 1 + seed % 4}, 0.5);
        int steps = 0;
        while (const auto at = side.next()) {
            ASSERT_LT(++steps, 64);
            state = state * 1664525u + 1013904223u;
            side.note(*at, (state >> 8) / 16777216.0);
        }
    }
}

TEST(SideSearch, ASideOfOneSizeIsKnown) {
    EXPECT_FALSE(SideSearch({1, 1}, 0.1).next());
    EXPECT_FALSE(SideSearch({4, 4}, 0.1).next());
    EXPECT_EQ(SideSearch({4, 4}, 0.1).least(), 1);
}

}  // namespace
}  // namespace citystream::codec::atlas
