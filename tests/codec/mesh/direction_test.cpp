#include "codec/mesh/direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace citystream::codec::mesh {
namespace {

TEST(Directions, AnglesAreExactFromTheTiniestToHalfATurn) {
    for (const double angle : {1e-16, 1e-12, 1e-9, 1e-8, 1e-4, 1.0, 2.0, 3.14})
        EXPECT_NEAR(angle_between({1, 0, 0}, {std::cos(angle), std::sin(angle), 0}), angle, 4e-16 * (1 + angle));
    EXPECT_EQ(angle_between({0, 0, 2}, {0, 0, -3}), std::numbers::pi);
    EXPECT_EQ(angle_between({0, 5, 0}, {0, 1e-300, 0}), 0);
}

TEST(Directions, LengthsFromDenormalToTheLargestAreBroughtToOne) {
    for (const double length : {5e-324, 1e-200, 1.0, 1e200, 1.7e308}) {
        const Direction n = unit_direction({length, 0, -length});
        EXPECT_DOUBLE_EQ(n[0], std::sqrt(0.5));
        EXPECT_EQ(n[2], -n[0]);
    }
}

TEST(Directions, WhatHasNoDirectionIsUp) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const Direction& none :
         {Direction{0, 0, 0}, Direction{-0.0, 0, 0}, Direction{1, nan, 0}, Direction{1, 0, -infinity}}) {
        EXPECT_EQ(unit_direction(none), (Direction{0, 0, 1}));
        EXPECT_EQ(scaled_direction(none), (Direction{0, 0, 1}));
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
