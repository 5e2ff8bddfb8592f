#include "codec/atlas/facade_tint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

std::vector<Tint> palette_of(size_t count) {
    tests::Dice dice(5);
    std::vector<Tint> palette(count);
    for (Tint& tint : palette) {
        for (float& channel : tint) channel = static_cast<float>(dice.roll(0, 255)) / 255;
    }
    return palette;
}

double difference(const Tint& a, const Tint& b) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(a[c] - b[c]);
    return sum;
}

TEST(FacadeTint, IsContinuousAcrossWholeNumbers) {
    const auto palette = palette_of(24);
    for (double whole = 0; whole < 100; ++whole) {
        for (const double t : {whole + 1 - 5e-5, whole, whole + 0.3})
            EXPECT_LT(difference(tint_at(palette, t + 1e-4), tint_at(palette, t)), 1e-2) << t;
    }
}

TEST(FacadeTint, ShowsEachPaletteColourAtItsNumber) {
    const auto palette = palette_of(24);
    for (size_t i = 0; i < 60; ++i) EXPECT_EQ(tint_at(palette, static_cast<double>(i)), palette[i % 24]);
    EXPECT_LT(difference(tint_at(palette_of(1), 3.7), palette_of(1)[0]), 1e-6);
}

TEST(FacadeTint, ChangesEverywhereAsSlowlyWithTheSumAndFasterFarAwayWithTheProduct) {
    const double near_sum = tint_parameter(TintField::kSum, 11, 10, 100) - tint_parameter(TintField::kSum, 10, 10, 100);
    const double far_sum =
        tint_parameter(TintField::kSum, 10001, 10000, 100) - tint_parameter(TintField::kSum, 10000, 10000, 100);
    EXPECT_NEAR(near_sum, far_sum, 1e-9);
    const double near_product =
        tint_parameter(TintField::kProduct, 11, 10, 100) - tint_parameter(TintField::kProduct, 10, 10, 100);
    const double far_product =
        tint_parameter(TintField::kProduct, 10001, 10000, 100) - tint_parameter(TintField::kProduct, 10000, 10000, 100);
    EXPECT_GT(far_product, 100 * near_product);
    EXPECT_DOUBLE_EQ(tint_parameter(TintField::kProduct, -20, 30, 100), 6);
}

}  // namespace
}  // namespace citystream::codec::atlas
