#include "codec/atlas/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "codec/atlas/wide_loops.h"
#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

double encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

TEST(Image, EveryByteSurvivesLinearLight) {
    for (uint32_t k = 0; k < 256; ++k) {
        const auto byte = static_cast<uint8_t>(k);
        EXPECT_EQ(srgb_of_linear(linear_of_srgb(byte)), byte);
    }
    EXPECT_EQ(linear_of_srgb(0), 0.0f);
    EXPECT_EQ(linear_of_srgb(255), 1.0f);
    EXPECT_NEAR(linear_of_srgb(188), 0.5029, 1e-4);
}

TEST(Image, LinearValuesRoundToTheNearestByteOfTheEncodedScale) {
    for (int i = 0; i <= 100'000; ++i) {
        const float value = static_cast<float>(i) / 100'000;
        const double exact = encode(static_cast<double>(value)) * 255;
        ASSERT_LE(std::abs(srgb_of_linear(value) - exact), 0.5001) << value;
    }
    EXPECT_EQ(srgb_of_linear(-1), 0);
    EXPECT_EQ(srgb_of_linear(7), 255);
    EXPECT_EQ(srgb_of_linear(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Image, EncodingFollowsTheFormula) {
    std::vector<float> in, out;
    for (int i = 0; i <= 100'001; ++i) in.push_back(static_cast<float>(i) / 100'001);
    in.insert(in.end(), {-1.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()});
    out.resize(in.size());
    encode_srgb(in, out);
    for (size_t i = 0; i + 3 < in.size(); ++i)
        ASSERT_NEAR(static_cast<double>(out[i]), encode(static_cast<double>(in[i])), 1e-6);
    EXPECT_EQ(out[0], 0.0f);
    EXPECT_EQ(out[out.size() - 3], 0.0f);
    EXPECT_NEAR(out[out.size() - 2], 1, 1e-6);
    EXPECT_EQ(out[out.size() - 1], 0.0f);
}

TEST(Image, ChartsComeBackAsTheyWere) {
    ChartImage chart;
    chart.width = 7;
    chart.height = 5;
    sample::Noise noise(3);
    for (size_t i = 0; i < 3 * 7 * 5; ++i) chart.rgb.push_back(static_cast<uint8_t>(noise()));
    const Image image = linear_image(chart);
    EXPECT_EQ(image.at(2, 4, 1), linear_of_srgb(chart.rgb[3 * (4 * 7 + 2) + 1]));
    EXPECT_EQ(chart_image(image).rgb, chart.rgb);
    Image rounded = image;
    quantise(rounded);
    EXPECT_EQ(rounded, image);
}

TEST(Image, AlphaIsMultipliedInAndTakenOutAgain) {
    const std::vector<uint8_t> bytes = {200, 100, 50, 128, 10, 20, 30, 0, 255, 0, 255, 255};
    const Image image = linear_image(3, 1, 4, bytes);
    EXPECT_NEAR(image.at(0, 0, 0), linear_of_srgb(200) * 128 / 255, 1e-7);
    EXPECT_EQ(image.at(1, 0, 0), 0.0f);
    const std::vector<uint8_t> back = srgb_bytes(image);
    EXPECT_EQ(std::vector<uint8_t>(back.begin(), back.begin() + 4), (std::vector<uint8_t>{200, 100, 50, 128}));
    EXPECT_EQ(std::vector<uint8_t>(back.begin() + 4, back.begin() + 8), (std::vector<uint8_t>{0, 0, 0, 0}));
    EXPECT_EQ(std::vector<uint8_t>(back.begin() + 8, back.end()), (std::vector<uint8_t>{255, 0, 255, 255}));
}

TEST(Image, QuantisingShowsWhatTheBytesShowWithAlphaToo) {
    sample::Noise noise(5);
    for (const uint32_t channels : {1u, 3u, 4u}) {
        Image image(64, 33, channels);
        for (size_t i = 0; i < image.area(); ++i) {
            const float alpha = static_cast<float>(noise()) / 255;
            for (uint32_t c = 0; c < channels; ++c)
                image.texels[c * image.area() + i] = channels < 4 ? static_cast<float>(noise()) / 255
                                                     : c < 3      ? alpha * static_cast<float>(noise()) / 255
                                                                  : alpha;
        }
        const std::vector<uint8_t> bytes = srgb_bytes(image);
        quantise(image);
        EXPECT_EQ(image, linear_image(64, 33, channels, bytes));
        EXPECT_EQ(linear_image(64, 33, channels, srgb_bytes(image)), image);
    }
}

TEST(Image, WhatIsLessThanHalfThereIsNotDrawn) {
    const std::vector<uint8_t> bytes = {200, 100, 50, 128, 10, 20, 30, 127, 255, 0, 255, 255};
    Image image = linear_image(3, 1, 4, bytes);
    test_alpha(image);
    EXPECT_EQ(srgb_bytes(image), (std::vector<uint8_t>{200, 100, 50, 255, 0, 0, 0, 0, 255, 0, 255, 255}));
    const Image opaque = sample::blotches(5, 7, 1);
    Image same = opaque;
    test_alpha(same);
    EXPECT_EQ(same, opaque);
}

TEST(WideLoops, LogarithmAndPowerAreTrue) {
    for (int i = 1; i <= 100'000; ++i) {
        const float x = static_cast<float>(i) / 1000;
        ASSERT_NEAR(fast_log2(x), std::log2(static_cast<double>(x)), 1e-6) << x;
        const float y = static_cast<float>(i) / 1000 - 50;
        ASSERT_NEAR(static_cast<double>(fast_exp2(y)) / std::exp2(static_cast<double>(y)), 1, 4e-7) << y;
    }
    EXPECT_LT(fast_pow(0, 1.0f / 3), 1e-12f);
    EXPECT_LT(fast_exp2(-1e9f), 1e-37f);
}

TEST(WideLoops, TransposingPutsEveryValueInItsPlace) {
    for (const auto& [width, height] :
         std::vector<std::pair<size_t, size_t>>{{1, 1}, {3, 9}, {8, 4}, {13, 7}, {32, 33}}) {
        std::vector<float> in(width * height), out(width * height);
        for (size_t i = 0; i < in.size(); ++i) in[i] = static_cast<float>(i);
        transpose(in.data(), width, width, height, out.data(), height);
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x < width; ++x) ASSERT_EQ(out[x * height + y], in[y * width + x]);
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
