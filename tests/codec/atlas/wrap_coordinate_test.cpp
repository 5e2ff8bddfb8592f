#include "codec/atlas/wrap_coordinate.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "codec/atlas/wrap_coordinate_layout.h"
#include "tests/codec/atlas/rectangle_sets.h"
#include "tests/shaders/wrap_coordinate_on_cpu.h"

namespace citystream::codec::atlas {
namespace {

using tests::Dice;

/// 0 .. 1, all bits of a float used.
double fraction(Dice& dice) {
    return dice.roll(0, (1u << 24) - 1) * 0x1p-24;
}

struct RandomAxis {
    uint32_t origin, size, border;
    double place;
};

RandomAxis random_axis(Dice& dice) {
    const uint32_t border = dice.roll(0, 2);
    const uint32_t size = 4 * dice.roll(border == 2 ? 2 : 1, 128);
    const uint32_t origin = 4 * dice.roll(0, (4096 - size) / 4);
    return {origin, size, border, std::min(64 * fraction(dice), std::nextafter(kWrapPlaceEnd, 0.0))};
}

TEST(WrapCoordinate, KeepsChartsExactlyAndPlacesToHalfAStepAMillionTimes) {
    Dice dice(1);
    for (int i = 0; i < 1'000'000; ++i) {
        const RandomAxis axis = random_axis(dice);
        const auto word = encode_wrap_axis(axis.origin, axis.size, axis.border, axis.place);
        ASSERT_TRUE(word.ok()) << word.error().text();
        const WrapAxis decoded = decode_wrap_axis(*word, axis.border);
        ASSERT_EQ(decoded.origin, axis.origin + axis.border);
        ASSERT_EQ(decoded.size, axis.size - 2 * axis.border);
        ASSERT_LE(std::abs(decoded.place * kWrapStep - axis.place), 1.0 / 1024);
        ASSERT_TRUE(check_wrap_axis(*word, axis.border, 4096).ok());
    }
}

TEST(WrapCoordinate, DecodesInTheShaderToTheSameBitsAMillionTimes) {
    Dice dice(2);
    for (int i = 0; i < 1'000'000; ++i) {
        const PackedCoordinate packed = {dice.roll(0, ~0u), dice.roll(0, ~0u)};
        const uint32_t border = dice.roll(0, 4);
        const ChartFrame frame = frame_of(packed, border);
        const auto place = [](uint32_t word) {
            return static_cast<float>(decode_wrap_axis(word, 0).place * kWrapStep);
        };
        const auto shader_frame = shaders_test::wrap_frame_on_cpu({packed.u, packed.v}, border);
        const auto shader_place = shaders_test::wrap_place_on_cpu({packed.u, packed.v});
        ASSERT_EQ(std::bit_cast<ChartFrame>(shader_frame), frame);
        ASSERT_EQ(shader_place, (std::array{place(packed.u), place(packed.v)}));
    }
}

/// Equation 2, and the half texel of the coarser level where an axis does not repeat.
float wrapped_texel(float origin, float size, float place, float level) {
    if (size >= 0) return origin + (place - std::floor(place)) * size;
    const float margin = std::min(0.5f * std::exp2(std::ceil(level)), -0.5f * size);
    return origin + std::clamp(place * -size, margin, -size - margin);
}

TEST(WrapCoordinate, WrapsInTheShaderToTheSameBitsAMillionTimes) {
    Dice dice(3);
    for (int i = 0; i < 1'000'000; ++i) {
        const float origin = static_cast<float>(dice.roll(0, 4095)), size = static_cast<float>(dice.roll(1, 512));
        const float place = static_cast<float>(70 * fraction(dice) - 3), level = static_cast<float>(3 * fraction(dice));
        const bool repeats = dice.roll(0, 1) != 0;
        const auto shader =
            shaders_test::wrap_texel_on_cpu({origin, origin, repeats ? size : -size, -size}, {place, place}, level);
        ASSERT_EQ(shader[0], wrapped_texel(origin, repeats ? size : -size, place, level));
        ASSERT_EQ(shader[1], wrapped_texel(origin, -size, place, level));
        ASSERT_GE(shader[0], origin);
        ASSERT_LE(shader[0], origin + size);
        ASSERT_GE(shader[1], origin + 0.5f);
        ASSERT_LE(shader[1], origin + size - 0.5f);
    }
}

TEST(WrapCoordinate, HoldsAChartOf512Texels) {
    const auto word = encode_wrap_axis(3584, 512, 2, 0.5);
    ASSERT_TRUE(word.ok());
    EXPECT_EQ(decode_wrap_axis(*word, 2).size, 508u);
    EXPECT_EQ(decode_wrap_axis(*word, 0).size, 512u);
    EXPECT_EQ(*word, 896u << 22 | 127u << 15 | 256u);
}

TEST(WrapCoordinate, CarriesAFractionThatRoundsToOneIntoTheWholePart) {
    const auto word = encode_wrap_axis(0, 64, 0, 3.9999);
    ASSERT_TRUE(word.ok());
    EXPECT_EQ(decode_wrap_axis(*word, 0).place, 4u * 512);
    const auto last = encode_wrap_axis(0, 64, 0, 63.999);
    ASSERT_TRUE(last.ok());
    EXPECT_EQ(decode_wrap_axis(*last, 0).place, 32767u);
    EXPECT_EQ(decode_wrap_axis(*last, 0).size, 64u);
}

TEST(WrapCoordinate, MovesAChartToEveryPlaceAndToNoOther) {
    const uint32_t word = encode_wrap_axis(4092, 4, 1, 63).value();
    for (uint32_t step = 0; step < 64 * 512; ++step) {
        const auto moved = move_wrap_axis(word, step * kWrapStep);
        ASSERT_TRUE(moved.ok());
        ASSERT_EQ(*moved, (word & ~WRAP_PLACE_MASK) | step);
    }
    for (const double bad : {-kWrapStep, kWrapPlaceEnd, 64.0, std::nan("")})
        EXPECT_FALSE(move_wrap_axis(word, bad).ok());
    for (const double place : {0.3, -7.7, 63.9999, 1e6 + 0.1})
        EXPECT_LE(std::abs(rounded_place(place) - place), kWrapStep / 2) << place;
}

TEST(WrapCoordinate, RefusesWhatItCannotHoldInsteadOfCuttingItOff) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    struct Bad {
        uint32_t origin, size, border;
        double place;
    };
    for (const Bad& bad : {Bad{0, 516, 0, 0},
                           {0, 1024, 0, 0},
                           {0, 0, 0, 0},
                           {2, 16, 0, 0},
                           {0, 18, 0, 0},
                           {4096, 4, 0, 0},
                           {8192, 4, 0, 0},
                           {0, 4, 2, 0},
                           {0, 8, 4, 0},
                           {0, 16, 0, 64},
                           {0, 16, 0, 63.9999},
                           {0, 16, 0, 64.5},
                           {0, 16, 0, -0.001},
                           {0, 16, 0, 1e300},
                           {0, 16, 0, nan},
                           {0, 16, 0, infinity}}) {
        const auto word = encode_wrap_axis(bad.origin, bad.size, bad.border, bad.place);
        ASSERT_FALSE(word.ok()) << bad.origin << " " << bad.size << " " << bad.border << " " << bad.place;
        EXPECT_FALSE(word.error().message.empty());
    }
    EXPECT_TRUE(encode_wrap_axis(4092, 4, 1, 63.998).ok());
    EXPECT_FALSE(encode_wrap_coordinate({0, 0, 16, 516}, 0, 0, 0).ok());
    EXPECT_FALSE(encode_wrap_coordinate({0, 0, 16, 16}, 0, 0, 64).ok());
}

TEST(WrapCoordinate, OfAWordNobodyVouchesForIsCheckedAgainstItsPage) {
    const auto word = encode_wrap_axis(1020, 8, 2, 1);
    ASSERT_TRUE(word.ok());
    EXPECT_TRUE(check_wrap_axis(*word, 2, 1028).ok());
    EXPECT_FALSE(check_wrap_axis(*word, 2, 1024).ok());
    EXPECT_FALSE(check_wrap_axis(*word, 4, 4096).ok());
    EXPECT_EQ(decode_wrap_axis(*word, 4).size, 0u);
    EXPECT_EQ(decode_wrap_axis(~0u, ~0u).size, 0u);
}

TEST(WrapShift, MovesAPolygonByAWholeNumberToZero) {
    const std::vector<double> places = {-3.25, 1.5, -0.75};
    const auto shift = wrap_shift(places);
    ASSERT_TRUE(shift.ok());
    EXPECT_EQ(*shift, -4);
    EXPECT_EQ(*wrap_shift(std::vector<double>{1e6 + 0.5, 1e6 + 63}), 1e6);
    EXPECT_EQ(*wrap_shift({}), 0);
}

TEST(WrapShift, RefusesAPolygonThatMustBeSplit) {
    EXPECT_FALSE(wrap_shift(std::vector<double>{0.0, 64.0}).ok());
    EXPECT_FALSE(wrap_shift(std::vector<double>{0.5, 64.0}).ok());
    EXPECT_FALSE(wrap_shift(std::vector<double>{-10.0, 53.9999}).ok());
    EXPECT_FALSE(wrap_shift(std::vector<double>{0.0, std::nan("")}).ok());
    EXPECT_FALSE(wrap_shift(std::vector<double>{0.0, 1e30}).ok());
    EXPECT_TRUE(wrap_shift(std::vector<double>{-10.0, 53.9}).ok());
}

TEST(WrapLevel, FollowsTheChartsSizeAndStaysWithinTheMipsOfThePage) {
    const std::array<float, 4> frame = {0, 0, 64, 128};
    const auto level = [&](float per_pixel_u, float per_pixel_v) {
        return shaders_test::wrap_level_on_cpu(frame, {per_pixel_u, 0}, {0, per_pixel_v}, 0, 2);
    };
    EXPECT_FLOAT_EQ(level(1.0f / 64, 1.0f / 128), 0);
    EXPECT_FLOAT_EQ(level(2.0f / 64, 1.0f / 128), 1);
    EXPECT_FLOAT_EQ(level(1.0f / 64, 3.0f / 128), std::log2(3.0f));
    EXPECT_FLOAT_EQ(level(1, 1), 2);
    EXPECT_FLOAT_EQ(level(0, 0), 0);
    // A clamped axis (negative size) counts as much.
    EXPECT_FLOAT_EQ(shaders_test::wrap_level_on_cpu({0, 0, -64, -64}, {2.0f / 64, 0}, {0, 0}, 0, 2), 1);
}

}  // namespace
}  // namespace citystream::codec::atlas
