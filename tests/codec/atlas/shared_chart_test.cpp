// Charts of the city's dictionary: their levels, and how tiles name them.
#include "codec/atlas/shared_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "codec/atlas/atlas_layout.h"
#include "tests/codec/damage.h"

namespace citystream::codec::atlas {
namespace {

constexpr uint32_t kRepeats = ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V;

ChartImage noisy_chart(uint32_t width, uint32_t height, bool repeat = true) {
    ChartImage image{width, height, repeat, repeat, 0.1F, {}};
    for (uint32_t i = 0; i < 3 * width * height; ++i) image.rgb.push_back(static_cast<uint8_t>(i * 37 + i / 11));
    return image;
}

LayerSteps steps_of(const ChartImage& image) {
    return encode_atlas(std::span(&image, 1));
}

std::vector<uint32_t> words_of(const LayerSteps& steps, size_t count) {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < count; ++i) words.insert(words.end(), steps[i].words.begin(), steps[i].words.end());
    return words;
}

TEST(SharedChart, SizesOfItsLevelsFollowFromItsOwn) {
    for (const uint32_t width : {1u, 3u, 4u, 37u, 64u, 100u, 513u}) {
        for (const uint32_t height : {1u, 5u, 64u, 300u}) {
            const LayerSteps steps = steps_of(noisy_chart(width, height));
            ASSERT_EQ(atlas_step_count(width, height, 0), steps.size()) << width << " x " << height;
            for (uint32_t step = 0; step < steps.size(); ++step) {
                EXPECT_EQ(atlas_step_words(width, height, 0, step), steps[step].words.size());
                EXPECT_EQ(atlas_step_finest_mip(width, height, 0, step), steps.size() - 1 - step);
            }
        }
    }
}

TEST(SharedChart, TheLargestOneHasEightLevels) {
    EXPECT_EQ(atlas_step_count(8192, 8192, 0), kMostChartLevels);
    EXPECT_EQ(atlas_step_words(8192, 8192, 0, 7), 1u + 2 * 2048 * 2048);
    EXPECT_LE(4 * atlas_step_words(8192, 8192, 0, 0), 4096u + 4 * (ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS));
    for (uint32_t width = 1; width <= 8192; width *= 2)
        EXPECT_LE(atlas_step_count(width, 8192, 0), kMostChartLevels) << width;
    EXPECT_EQ(atlas_step_count(64, 64, 0), 1u) << "all mips take less than 4 KiB";
}

TEST(SharedChart, LevelsComeBackFromTheirPayloads) {
    const LayerSteps steps = steps_of(noisy_chart(200, 90, false));
    const auto payloads = encode_chart_levels(steps);
    ASSERT_EQ(payloads.size(), steps.size());
    ASSERT_GT(steps.size(), 1u);
    for (uint32_t step = 0; step < steps.size(); ++step) {
        EXPECT_TRUE(chart_level_is_whole(payloads[step]));
        const auto words = decode_chart_level(payloads[step], 200, 90, 0, step);
        ASSERT_TRUE(words.ok()) << words.error().text();
        EXPECT_EQ(*words, steps[step].words);
        const auto view = shared_chart_view(words_of(steps, step + 1), 200, 90, 0, step + 1);
        ASSERT_TRUE(view.ok()) << view.error().text();
        EXPECT_EQ(view->finest_mip(), atlas_step_finest_mip(200, 90, 0, step));
    }
}

TEST(SharedChart, EveryDamagedOrShortPayloadIsRefused) {
    const auto payloads = encode_chart_levels(steps_of(noisy_chart(12, 9)));
    std::vector<std::byte> payload = payloads[0];
    for (size_t i = 0; i < payload.size(); ++i) {
        payload[i] ^= std::byte{4};
        EXPECT_FALSE(chart_level_is_whole(payload)) << i;
        EXPECT_FALSE(decode_chart_level(payload, 12, 9, kRepeats, 0).ok()) << i;
        payload[i] ^= std::byte{4};
        EXPECT_FALSE(decode_chart_level(std::span(payload).first(i), 12, 9, kRepeats, 0).ok()) << i;
    }
    EXPECT_FALSE(decode_chart_level(payload, 17, 9, kRepeats, 0).ok()) << "a chart of another size";
    EXPECT_TRUE(decode_chart_level(payload, 12, 9, kRepeats, 0).ok());
}

TEST(SharedChart, TheViewIsOfExactlyTheChartThatTheIndexLists) {
    const LayerSteps steps = steps_of(noisy_chart(12, 9));
    const std::vector<uint32_t>& words = steps[0].words;
    EXPECT_TRUE(shared_chart_view(words, 12, 9, kRepeats, 1).ok());
    EXPECT_FALSE(shared_chart_view(words, 12, 9, 0, 1).ok());
    EXPECT_FALSE(shared_chart_view(words, 9, 12, kRepeats, 1).ok());
    EXPECT_FALSE(shared_chart_view(words, 11, 9, kRepeats, 1).ok()) << "as many blocks, but another width";
    const SharedChartUse use{0, 1, 0.5F};
    const LayerSteps nested = encode_atlas({}, {}, std::span(&use, 1));
    EXPECT_FALSE(shared_chart_view(nested[0].words, 12, 9, kRepeats, 1).ok()) << "names another chart";
    size_t refused = 0;
    for_each_mutation(words, [&](std::span<const uint32_t> damaged) {
        const auto view = shared_chart_view(damaged, 12, 9, kRepeats, 1);
        if (!view.ok()) {
            ++refused;
            return;
        }
        for (uint32_t mip = 0; mip < view->mip_count(0); ++mip) {
            uint8_t rgb[3];
            view->texel(0, mip, (12u >> mip) == 0 ? 0 : (12u >> mip) - 1, (9u >> mip) == 0 ? 0 : (9u >> mip) - 1, rgb);
        }
    });
    EXPECT_GT(refused, 0u);
}

TEST(SharedChart, MetresAreRoundedToTheNearestOfEightBits) {
    for (const float metres : {0.0F, 1.0F, 0.05F, 0.0123F, 317.77F, 1e-30F}) {
        const float back = from_coarse_float_bits(coarse_float_bits(metres));
        EXPECT_NEAR(back, metres, metres / 256) << metres;
    }
    EXPECT_EQ(coarse_float_bits(1.0F), 0x3f80u);
    EXPECT_EQ(coarse_float_bits(std::nextafter(1.00390625F, 2.0F)), 0x3f81u) << "above the middle of two";
    EXPECT_TRUE(std::isfinite(from_coarse_float_bits(coarse_float_bits(std::numeric_limits<float>::max()))));
}

}  // namespace
}  // namespace citystream::codec::atlas
