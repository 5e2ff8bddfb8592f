#include "client/render/tone.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::client {
namespace {

TEST(Tone, IsStraightThenBendsGrowsAndStaysBelowOne) {
    EXPECT_EQ(tone(0.6), 0.6);
    EXPECT_NEAR(tone(0.6001), 0.6001, 1e-7) << "no kink";
    double before = -1;
    for (int i = 0; i < 300; ++i) {
        const double shown = tone(0.001 * (std::pow(1.05, i) - 1));
        EXPECT_GT(shown, before);
        EXPECT_LT(shown, 1);
        before = shown;
    }
    EXPECT_LT(tone(1e30), 1.0000001);
}

TEST(Tone, SrgbGoesThereAndBack) {
    for (int value = 0; value <= 255; ++value)
        EXPECT_NEAR(srgb_encoded(srgb_decoded(value / 255.0)), value / 255.0, 1e-5);
    EXPECT_NEAR(srgb_decoded(0.5), 0.21404, 1e-5);
}

}  // namespace
}  // namespace citystream::client
