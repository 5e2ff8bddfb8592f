// Means of sRGB bytes in linear light.
#include "codec/atlas/linear_bytes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::codec::atlas {
namespace {

double decoded(double byte) {
    const double value = byte / 255;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double encoded(double linear) {
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

TEST(LinearBytes, EqualValuesKeepTheirs) {
    const LinearBytes& light = LinearBytes::tables();
    for (uint32_t k = 0; k < 256; ++k) {
        const uint32_t own = light.linear(static_cast<uint8_t>(k));
        EXPECT_EQ(light.mean_of_four(4 * own), k);
        EXPECT_EQ(light.mean(uint64_t{own} * 12345, 12345), k);
    }
}

TEST(LinearBytes, MeansAreTheNearestValue) {
    const LinearBytes& light = LinearBytes::tables();
    for (uint32_t a = 0; a < 256; ++a) {
        for (uint32_t b = 0; b < 256; ++b) {
            const double exact = encoded((3 * decoded(a) + decoded(b)) / 4);
            const uint32_t low = light.linear(static_cast<uint8_t>(a)), high = light.linear(static_cast<uint8_t>(b));
            ASSERT_NEAR(light.mean_of_four(3 * low + high), exact, 0.51) << a << ' ' << b;
            ASSERT_EQ(light.mean(30 * uint64_t{low} + 10 * high, 40), light.mean_of_four(3 * low + high));
        }
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
