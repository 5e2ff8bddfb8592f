#include "codec/mesh/uniform_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace citystream::codec::mesh {
namespace {

TEST(UniformNumber, ErrorIsAtMostHalfAStepForEveryValueAndIndicesStayInRange) {
    std::mt19937_64 random(1);
    for (const UniformRange range : {UniformRange{-17.25, 4.5, 16}, UniformRange{0, 1, 1}, UniformRange{-3, -2, 25},
                                     UniformRange{1e7, 1e7 + 300, 12}, UniformRange{-1e38, 1e38, 32}}) {
        std::uniform_real_distribution<double> inside(range.low, range.high);
        const double last = std::ldexp(1.0, static_cast<int>(range.bits)) - 1;
        for (int i = 0; i < 200000; ++i) {
            const double value = inside(random);
            const uint32_t index = range.pack(value);
            ASSERT_LE(index, last);
            ASSERT_LE(std::fabs(range.unpack(index) - value), range.step() / 2 * (1 + 1e-9)) << value;
        }
        EXPECT_EQ(range.unpack(range.pack(range.low)), range.low);
        EXPECT_EQ(range.unpack(range.pack(range.high)), range.high);
        EXPECT_EQ(range.pack(range.high), static_cast<uint32_t>(last));
    }
}

TEST(UniformNumber, WhatIsOutsideOrNoNumberGoesToAnEnd) {
    const UniformRange range{-1, 1, 10};
    EXPECT_EQ(range.pack(-1e300), 0u);
    EXPECT_EQ(range.pack(1e300), 1023u);
    EXPECT_EQ(range.pack(std::numeric_limits<double>::quiet_NaN()), 0u);
    EXPECT_EQ(range.pack(std::numeric_limits<double>::infinity()), 1023u);
}

TEST(UniformNumber, RangesOfNoOrTinyExtentDecodeToTheirValue) {
    for (const uint32_t bits : {1u, 16u, 32u}) {
        const UniformRange point{5, 5, bits};
        EXPECT_EQ(point.unpack(point.pack(5)), 5);
        const UniformRange tiny{0, 1e-38, bits};
        EXPECT_LE(std::fabs(tiny.unpack(tiny.pack(4e-39)) - 4e-39), tiny.step() / 2 * (1 + 1e-9));
    }
}

TEST(UniformNumber, TwentyFiveBitsMatchTheCoarsestFloatOfAModel) {
    std::mt19937_64 random(2);
    for (const double size : {1.0, 0.75, 0.9999999, 1000.0, 1023.999, 3e-5}) {
        // The grid of a model that reaches from -size to size, as the floats at its ends are spaced.
        const UniformRange range{-size, size, bits_to_match_floats(23)};
        std::uniform_real_distribution<double> inside(-size, size);
        double worst = 0;
        for (int i = 0; i < 100000; ++i) {
            const double value = inside(random);
            worst = std::max(worst, std::fabs(range.unpack(range.pack(value)) - value));
        }
        EXPECT_LE(worst, 0.501 * float_spacing(size)) << size;
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
