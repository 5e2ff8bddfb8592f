// The sample pattern of the facade pass, run on the CPU, against its statement.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/shaders/facade_on_cpu.h"

namespace citystream::shaders_test {
namespace {

TEST(FacadeSamples, BeginAtTheCentreAndFillEveryColumnAndRowOfThePixelOnce) {
    for (const uint32_t count : client::kFacadeSampleCounts) {
        std::set<int> columns, rows;
        double x = 0, y = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const auto [a, b] = sample_offset_on_cpu(i, count);
            if (i == 0) {
                EXPECT_EQ(a, 0.0f);
                EXPECT_EQ(b, 0.0f);
            }
            EXPECT_LT(std::max(std::abs(a), std::abs(b)), 0.5f);
            columns.insert(static_cast<int>(std::lround(a * static_cast<float>(count))));
            rows.insert(static_cast<int>(std::lround(b * static_cast<float>(count))));
            x += static_cast<double>(a);
            y += static_cast<double>(b);
        }
        EXPECT_EQ(columns.size(), count);
        EXPECT_EQ(rows.size(), count);
        EXPECT_NEAR(x, 0, 1e-6) << "the mean of the samples is the pixel's centre";
        EXPECT_NEAR(y, 0, 1e-6);
    }
}

/// How many samples a pixel takes that sees a wall from the front, `texels` a pixel, with runs of 6 x 10 texels.
uint32_t count_in_front(float texels, uint32_t most) {
    const float ray[3] = {0, 0, -1000}, right[3] = {texels / 2, 0, 0}, down[3] = {0, -texels / 2, 0};
    const float finest[2] = {6, 10};
    return sample_count_on_cpu(ray, right, down, 2, finest, most);
}

TEST(FacadeSamples, AreMoreThanOneWhereTheFinestRunsCoverLessThanTwoPixels) {
    for (const uint32_t most : client::kFacadeSampleCounts) {
        EXPECT_EQ(count_in_front(0.5f, most), 1u);
        EXPECT_EQ(count_in_front(2.99f, most), 1u);
        EXPECT_EQ(count_in_front(3.01f, most), most);
        EXPECT_EQ(count_in_front(100, most), most);
    }
}

// From beside, a pixel covers more of the wall along it, and endlessly much from in its plane.
TEST(FacadeSamples, FollowTheFootprintOfObliqueRays) {
    const float finest[2] = {6, 6}, down[3] = {0, -1, 0};
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0, 90.0}) {
        // 10 mm a texel: unit directions in the plane of u and w, and what is square to them.
        const double angle = degrees * 3.14159265358979323846 / 180;
        const auto sine = static_cast<float>(std::sin(angle)), cosine = static_cast<float>(std::cos(angle));
        const float ray[3] = {sine * 100, 0, degrees == 90 ? 0 : -cosine * 1000}, right[3] = {cosine, 0, sine * 10};
        // A step of one texel square to the ray covers 1 / cos of them on the wall.
        const double covered = degrees == 90 ? std::numeric_limits<double>::infinity() : 1 / std::cos(angle);
        EXPECT_EQ(sample_count_on_cpu(ray, right, down, 1, finest, 5), 2 * covered <= 6 ? 1u : 5u) << degrees;
    }
}

}  // namespace
}  // namespace citystream::shaders_test
