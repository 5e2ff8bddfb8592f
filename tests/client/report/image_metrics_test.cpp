#include "client/report/image_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::client {
namespace {

FrameImage flat(uint32_t width, uint32_t height, std::array<uint8_t, 3> rgb) {
    FrameImage image{width, height, std::vector<uint8_t>(size_t{4} * width * height, 255)};
    for (size_t i = 0; i < size_t{width} * height; ++i) std::copy(rgb.begin(), rgb.end(), &image.rgba[4 * i]);
    return image;
}

FrameImage noisy(FrameImage image, int amplitude, uint32_t seed) {
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        seed = seed * 1664525u + 1013904223u;
        image.rgba[i] = static_cast<uint8_t>(
            std::clamp(image.rgba[i] + static_cast<int>(seed >> 16) % (2 * amplitude + 1) - amplitude, 0, 255));
    }
    return image;
}

TEST(ImageMetrics, EqualPicturesHaveNoDifference) {
    const FrameImage image = noisy(flat(64, 48, {90, 120, 60}), 40, 1);
    const auto difference = compare_images(image, image);
    ASSERT_TRUE(difference);
    EXPECT_TRUE(std::isinf(difference->psnr_db));
    EXPECT_NEAR(difference->ssim, 1, 1e-6);
    EXPECT_NEAR(difference->flip, 0, 1e-6);
}

TEST(ImageMetrics, PsnrOfAConstantOffsetIsItsClosedForm) {
    const double expected = 20 * std::log10(255.0 / 5);
    EXPECT_NEAR(psnr(flat(16, 16, {100, 100, 100}), flat(16, 16, {105, 105, 105})), expected, 1e-9);
}

TEST(ImageMetrics, FlipOfBlackAgainstWhiteIsNearItsMaximumAndOrdersNoise) {
    const auto most = compare_images(flat(64, 64, {0, 0, 0}), flat(64, 64, {255, 255, 255}));
    ASSERT_TRUE(most);
    EXPECT_GT(most->flip, 0.9);
    EXPECT_LE(most->flip, 1.0);
    const FrameImage grey = flat(64, 64, {128, 128, 128});
    const auto little = compare_images(grey, noisy(grey, 4, 7)), more = compare_images(grey, noisy(grey, 24, 7));
    ASSERT_TRUE(little && more);
    EXPECT_GT(little->flip, 0);
    EXPECT_GT(more->flip, 1.5 * little->flip);
    EXPECT_GT(little->ssim, more->ssim);
}

TEST(ImageMetrics, FlipOfPureColoursIsTheRedistributedHyabDistance) {
    // Blue against green is the largest distance of the redistribution, so its colour difference is exactly one.
    const auto map = flip_map(flat(80, 80, {0, 255, 0}), flat(80, 80, {0, 0, 255}));
    EXPECT_NEAR(map[40 * 80 + 40], 1.0, 1e-3);
}

TEST(ImageMetrics, AnEdgeCountsMoreThanTheSameColourDifferenceWithoutOne) {
    FrameImage line = flat(64, 64, {128, 128, 128});
    for (size_t y = 0; y < 64; ++y)
        for (size_t c = 0; c < 3; ++c) line.rgba[4 * (y * 64 + 32) + c] = 160;
    const auto map = flip_map(flat(64, 64, {128, 128, 128}), line);
    EXPECT_GT(map[32 * 64 + 32], 5 * map[32 * 64 + 4]);
}

TEST(ImageMetrics, SizesMustAgree) {
    EXPECT_FALSE(compare_images(flat(8, 8, {0, 0, 0}), flat(8, 9, {0, 0, 0})));
    EXPECT_FALSE(compare_images(FrameImage{}, FrameImage{}));
}

}  // namespace
}  // namespace citystream::client
