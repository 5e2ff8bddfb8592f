#include "tests/bench/coded_halves.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::bench {
namespace {

TEST(CodedHalves, EveryFiniteHalfComesBackAsItself) {
    for (uint32_t half = 0; half < 0x10000; ++half) {
        if ((half & 0x7c00) == 0x7c00) continue;  // infinite, or no number
        const auto code = static_cast<uint16_t>(half);
        EXPECT_EQ(to_half(from_half(code)), code);
    }
}

TEST(CodedHalves, NumbersBecomeTheNearestHalf) {
    EXPECT_EQ(to_half(0), 0);
    EXPECT_EQ(to_half(1), 0x3c00);
    EXPECT_EQ(to_half(-2), 0xc000);
    EXPECT_EQ(to_half(0x1p-24F), 1);
    EXPECT_EQ(to_half(1e9F), 0x7bff);
    EXPECT_EQ(to_half(1 + 0x1p-11F), 0x3c00) << "ties go to even";
    EXPECT_EQ(to_half(1 + 0x1.8p-10F), 0x3c02);
    for (float value = 1e-4F; value < 6e4F; value *= 1.37F)
        EXPECT_LE(std::abs(rounded_to_half(value) - value), value * 0x1p-11F);
}

TEST(CodedHalves, WhatRepeatsTakesLess) {
    std::vector<uint16_t> same(1000, 0x1234), different;
    uint32_t state = 1;
    for (size_t i = 0; i < 1000; ++i)
        different.push_back(static_cast<uint16_t>((state = state * 1664525 + 1013904223) >> 16));
    EXPECT_LT(coded_bytes(same), 100U);
    EXPECT_GT(coded_bytes(different), 1900U);
    std::vector<uint32_t> rising;
    for (uint32_t i = 0; i < 1000; ++i) rising.push_back(7 * i);
    EXPECT_LT(coded_bytes(rising), 200U) << "steps are told";
}

}  // namespace
}  // namespace citystream::bench
