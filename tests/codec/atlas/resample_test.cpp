#include "codec/atlas/resample.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

constexpr Shrink kFilters[] = {Shrink::kArea, Shrink::kLanczos, Shrink::kBilinear};

double mean_of(const Image& image, uint32_t channel) {
    double sum = 0;
    for (const float value : image.plane(channel)) sum += static_cast<double>(value);
    return sum / static_cast<double>(image.area());
}

double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (size_t i = 0; i < a.texels.size(); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(a.texels[i]) - static_cast<double>(b.texels[i])));
    return largest;
}

TEST(Resample, AFlatPictureStaysFlatAtEverySize) {
    const Image image = sample::flat(37, 21, 200, 100, 3);
    for (const Shrink filter : kFilters) {
        for (const auto& [w, h] :
             std::vector<std::pair<uint32_t, uint32_t>>{{1, 1}, {36, 20}, {5, 21}, {80, 3}, {99, 64}}) {
            const Image out = resample(image, w, h, filter);
            ASSERT_EQ(out.width, w);
            ASSERT_EQ(out.height, h);
            for (uint32_t c = 0; c < 3; ++c)
                for (const float value : out.plane(c)) ASSERT_NEAR(value, image.at(0, 0, c), 2e-6);
        }
    }
}

TEST(Resample, TheSameSizeIsTheSamePicture) {
    const Image image = sample::blotches(19, 23, 1);
    for (const Shrink filter : kFilters) EXPECT_EQ(resample(image, 19, 23, filter), image);
}

TEST(Resample, AreaIsTheExactMeanOfEachFootprint) {
    const Image image = sample::blotches(6, 4, 2);
    const Image half = resample(image, 3, 2, Shrink::kArea);
    for (uint32_t y = 0; y < 2; ++y) {
        for (uint32_t x = 0; x < 3; ++x) {
            const float mean = (image.at(2 * x, 2 * y, 0) + image.at(2 * x + 1, 2 * y, 0) +
                                image.at(2 * x, 2 * y + 1, 0) + image.at(2 * x + 1, 2 * y + 1, 0)) /
                               4;
            EXPECT_NEAR(half.at(x, y, 0), mean, 1e-6);
        }
    }
    // 5 texels to 2: the middle one belongs to both by half.
    const Image five = sample::blotches(5, 1, 3), two = resample(five, 2, 1, Shrink::kArea);
    EXPECT_NEAR(two.at(0, 0, 0), (five.at(0, 0, 0) + five.at(1, 0, 0) + five.at(2, 0, 0) / 2) / 2.5f, 1e-6);
    EXPECT_NEAR(two.at(1, 0, 0), (five.at(4, 0, 0) + five.at(3, 0, 0) + five.at(2, 0, 0) / 2) / 2.5f, 1e-6);
}

TEST(Resample, FineStripesShrinkToTheGreyTheyLookLike) {
    // Pitfall 15: half black, half white is half the light, byte 188; a box over encoded values says 128, and sampling
    // without a prefilter finds black or white.
    const Image stripes = sample::picture(96, 96, [](uint32_t x, uint32_t, uint32_t) { return x % 2 ? 255 : 0; });
    for (const Shrink filter : {Shrink::kArea, Shrink::kLanczos}) {
        const Image small = resample(stripes, 24, 24, filter);
        for (uint32_t x = 2; x < 22; ++x) EXPECT_NEAR(srgb_of_linear(small.at(x, 12, 0)), 188, 1);
    }
    const Image aliased = resample(stripes, 32, 32, Shrink::kBilinear);
    EXPECT_TRUE(srgb_of_linear(aliased.at(10, 16, 0)) == 0 || srgb_of_linear(aliased.at(10, 16, 0)) == 255);
}

TEST(Resample, ShrinkingKeepsTheLight) {
    const Image image = sample::blotches(64, 48, 5);
    EXPECT_NEAR(mean_of(resample(image, 13, 7, Shrink::kArea), 1), mean_of(image, 1), 1e-5);
    EXPECT_NEAR(mean_of(resample(image, 13, 7, Shrink::kLanczos), 1), mean_of(image, 1), 0.01);
}

TEST(Resample, LanczosStaysWithinWhatLightThereIs) {
    const Image edges =
        sample::picture(64, 64, [](uint32_t x, uint32_t y, uint32_t) { return x / 16 % 2 == y / 16 % 2 ? 255 : 0; });
    for (const float value : resample(edges, 23, 29, Shrink::kLanczos).texels) {
        ASSERT_GE(value, 0);
        ASSERT_LE(value, 1);
    }
}

TEST(Resample, ARepeatingPictureShrinksAsPartOfItsRepetition) {
    const Image tile = sample::blotches(24, 18, 7);
    Image tiled(72, 54, 3);
    for (uint32_t c = 0; c < 3; ++c)
        for (uint32_t y = 0; y < 54; ++y)
            for (uint32_t x = 0; x < 72; ++x) tiled.at(x, y, c) = tile.at(x % 24, y % 18, c);
    for (const Shrink filter : kFilters) {
        for (const auto& [w, h] : std::vector<std::pair<uint32_t, uint32_t>>{{12, 9}, {10, 7}, {40, 31}}) {
            const Image one = resample(tile, w, h, filter, {true, true}), all = resample(tiled, 3 * w, 3 * h, filter);
            for (uint32_t c = 0; c < 3; ++c)
                for (uint32_t y = 0; y < h; ++y)
                    for (uint32_t x = 0; x < w; ++x) ASSERT_NEAR(one.at(x, y, c), all.at(x + w, y + h, c), 1e-5);
        }
    }
}

TEST(Resample, EnlargedRowsAreTheEnlargedPicture) {
    const Image small = sample::blotches(11, 9, 8);
    for (const auto& [w, h] : std::vector<std::pair<uint32_t, uint32_t>>{{11, 9}, {11, 70}, {50, 9}, {50, 70}}) {
        const Image whole = resample(small, w, h, Shrink::kArea, {true, false});
        EXPECT_EQ(largest_difference(whole_image(enlarged_rows(small, w, h, {true, false})), whole), 0);
    }
}

TEST(Resample, BytesShrinkAsTheirFloatsDo) {
    ChartImage chart;
    chart.width = 100;
    chart.height = 67;
    sample::Noise noise(9);
    for (size_t i = 0; i < size_t{3} * 100 * 67; ++i) chart.rgb.push_back(static_cast<uint8_t>(noise()));
    for (const Shrink filter : kFilters) {
        const Image from_bytes = resample(chart, 31, 22, filter);
        const Image wide_first =
            resample_height(resample_width(linear_image(chart), 31, filter, false), 22, filter, false);
        EXPECT_EQ(from_bytes, wide_first);
    }
}

TEST(Resample, ExtremeShapesKeepTheirSizeAndStayFinite) {
    for (const auto& [w, h] : std::vector<std::pair<uint32_t, uint32_t>>{{1, 1}, {1, 4096}, {4096, 4}, {2, 3}}) {
        const Image image = sample::blotches(w, h, 10);
        for (const Shrink filter : kFilters) {
            for (const Edges edges : {Edges{false, false}, Edges{true, true}}) {
                const Image out = resample(resample(image, std::max(1u, w / 7), 1, filter, edges), w, h, filter, edges);
                for (const float value : out.texels) ASSERT_TRUE(value >= 0 && value <= 1);
            }
        }
    }
}

TEST(Resample, NamesAreParsed) {
    for (const Shrink filter : kFilters) EXPECT_EQ(parse_shrink(name_of(filter)), filter);
    EXPECT_FALSE(parse_shrink("cubic"));
}

}  // namespace
}  // namespace citystream::codec::atlas
