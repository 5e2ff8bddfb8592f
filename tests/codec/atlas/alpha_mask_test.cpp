#include "codec/atlas/alpha_mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "codec/atlas/image.h"
#include "codec/atlas/resample.h"

namespace citystream::codec::atlas {
namespace {

using Shape = std::function<bool(double u, double v)>;

/// Green where the shape is, magenta and not there elsewhere.
ChartImage masked(uint32_t width, uint32_t height, const Shape& shape) {
    ChartImage image{width, height, true, true, 0.01F, {}, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const bool there = shape((x + 0.5) / width, (y + 0.5) / height);
            const std::array<uint8_t, 3> rgb =
                there ? std::array<uint8_t, 3>{20, 160, 30} : std::array<uint8_t, 3>{255, 0, 255};
            image.rgb.insert(image.rgb.end(), rgb.begin(), rgb.end());
            image.alpha.push_back(there ? 255 : 0);
        }
    }
    return image;
}

/// Bars of a wire fence, 3 of 16 texels each way: 34 % of it is there.
ChartImage fence() {
    return masked(256, 256, [](double u, double v) {
        return std::fmod(u * 16, 1.0) < 3.0 / 16 || std::fmod(v * 16, 1.0) < 3.0 / 16;
    });
}

ChartImage posts() {
    return masked(256, 128, [](double u, double) { return std::fmod(u * 32, 1.0) < 0.13; });
}

ChartImage tree() {
    return masked(128, 256, [](double u, double v) {
        const double x = u - 0.5, y = v - 0.6;
        const bool crown = x * x * 4 + y * y * 4 < 0.9 && std::sin(37 * u + 11 * v) * std::sin(29 * v - 17 * u) > -0.3;
        return crown || (std::abs(x) < 0.05 && v < 0.3);
    });
}

TEST(AlphaMask, ThereIsAsMuchAtEveryMipAsInTheImage) {
    for (const ChartImage& image : {fence(), posts(), tree()}) {
        const double share = there_of(image).value();
        ASSERT_GT(share, 0.1);
        ASSERT_LT(share, 0.9);
        ChartImage mip = image;
        while (mip.width * mip.height >= 4 * kLeastAlphaTexels) {
            mip = downsample(mip);
            EXPECT_NEAR(there_of(mip).value(), share, 0.1 * share) << mip.width << " x " << mip.height;
        }
    }
}

TEST(AlphaMask, APlainFilterWouldLoseOrCloseTheSame) {
    for (const ChartImage& image : {fence(), posts()}) {
        const double share = there_of(image).value();
        Image plain = resample(image, image.width / 16, image.height / 16, Shrink::kArea);
        const double left = there_of(chart_image(plain)).value();
        EXPECT_GT(std::abs(left - share), 0.1 * share);
    }
}

TEST(AlphaMask, SharesAreKeptByResamplingToAnySize) {
    const ChartImage image = fence();
    const AreaShare share = there_of(image);
    for (const uint32_t side : {200U, 99U, 64U, 33U, 17U, 8U}) {
        ChartImage small = chart_image(resample(image, side, side, Shrink::kLanczos, {true, true}));
        small.repeat_u = small.repeat_v = true;
        keep_share(small, share);
        EXPECT_NEAR(there_of(small).value(), share.value(), 0.1 * share.value()) << side;
    }
}

TEST(AlphaMask, NothingAndAllStayWhatTheyAre) {
    for (const uint8_t alpha : {uint8_t{0}, uint8_t{255}}) {
        ChartImage image = masked(32, 16, [](double, double) { return true; });
        std::fill(image.alpha.begin(), image.alpha.end(), alpha);
        EXPECT_EQ(there_of(image).value(), alpha / 255);
        EXPECT_EQ(there_of(downsample(image)).value(), alpha / 255);
    }
    ChartImage opaque = masked(8, 8, [](double, double) { return true; });
    EXPECT_TRUE(all_there(opaque.alpha));
    opaque.alpha[7] = kAlphaTest;
    EXPECT_TRUE(all_there(opaque.alpha));
    opaque.alpha[7] = kAlphaTest - 1;
    EXPECT_FALSE(all_there(opaque.alpha));
}

TEST(AlphaMask, ColoursOfWhatIsNotThereNeverShow) {
    ChartImage image = tree();
    fill_hidden_colours(image);
    for (int mip = 0; mip < 5; ++mip, image = downsample(image)) {
        for (size_t i = 0; i < image.alpha.size(); ++i)
            ASSERT_LT(image.rgb[3 * i], 100) << "magenta at mip " << mip << ", texel " << i;
    }
    ChartImage linear = chart_image(resample(tree(), 31, 57, Shrink::kArea));
    fill_hidden_colours(linear);
    for (size_t i = 0; i < linear.alpha.size(); ++i) ASSERT_LT(linear.rgb[3 * i], 100) << i;
}

TEST(AlphaMask, OddSidesHalveLikeThoseOfColours) {
    ChartImage image = masked(37, 5, [](double u, double) { return u < 0.5; });
    ChartImage plain = image;
    plain.alpha.clear();
    const ChartImage coarse = downsample(image), expected = downsample(plain);
    EXPECT_EQ(coarse.width, expected.width);
    EXPECT_EQ(coarse.height, expected.height);
    EXPECT_EQ(coarse.alpha.size(), size_t{coarse.width} * coarse.height);
    EXPECT_EQ(coarse.metres_per_texel, expected.metres_per_texel);
    std::fill(image.alpha.begin(), image.alpha.end(), uint8_t{255});
    EXPECT_EQ(downsample(image).rgb, expected.rgb) << "what is there everywhere is filtered as without alpha";
}

}  // namespace
}  // namespace citystream::codec::atlas
