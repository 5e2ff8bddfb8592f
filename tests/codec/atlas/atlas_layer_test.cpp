#include "codec/atlas/atlas_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/image.h"
#include "tests/codec/damage.h"

namespace citystream::codec::atlas {
namespace {

struct Prefix {
    std::vector<uint32_t> words;
    std::vector<uint32_t> step_words;
};

Prefix prefix_of(const LayerSteps& steps, size_t count) {
    Prefix prefix;
    for (size_t s = 0; s < count; ++s) {
        prefix.words.insert(prefix.words.end(), steps[s].words.begin(), steps[s].words.end());
        prefix.step_words.push_back(static_cast<uint32_t>(steps[s].words.size()));
    }
    return prefix;
}

ChartImage smooth_chart(uint32_t width, uint32_t height, float metres_per_texel = 0.01f) {
    ChartImage image;
    image.width = width;
    image.height = height;
    image.repeat_u = true;
    image.metres_per_texel = metres_per_texel;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t grey = (x + y) * 255 / (width + height);
            for (uint32_t c = 0; c < 3; ++c) image.rgb.push_back(static_cast<uint8_t>(grey));
        }
    }
    return image;
}

TEST(AtlasLayer, DownsampleAveragesEvenSizesInLinearLight) {
    ChartImage image{4, 2, true, false, 0.5f, {}};
    for (const int value : {0, 1, 0, 255, 1, 0, 255, 0})
        image.rgb.insert(image.rgb.end(), 3, static_cast<uint8_t>(value));
    const ChartImage coarse = downsample(image);
    EXPECT_EQ(coarse.width, 2u);
    EXPECT_EQ(coarse.height, 1u);
    EXPECT_TRUE(coarse.repeat_u);
    EXPECT_FALSE(coarse.repeat_v);
    EXPECT_EQ(coarse.metres_per_texel, 1.0f);
    EXPECT_EQ(coarse.rgb[0], 1) << "0.5 rounds up";
    EXPECT_EQ(coarse.rgb[3], 188) << "half of white's light";
}

TEST(AtlasLayer, DownsampleWeighsThreeTapsOfOddSizes) {
    ChartImage image{5, 1, false, false, 1, {}};
    for (const int value : {100, 0, 50, 0, 200}) image.rgb.insert(image.rgb.end(), 3, static_cast<uint8_t>(value));
    const ChartImage coarse = downsample(image);
    ASSERT_EQ(coarse.width, 2u);
    EXPECT_EQ(coarse.rgb[0], srgb_of_linear((2 * linear_of_srgb(100) + linear_of_srgb(50)) / 5));
    EXPECT_EQ(coarse.rgb[3], srgb_of_linear((linear_of_srgb(50) + 2 * linear_of_srgb(200)) / 5));
    EXPECT_EQ(downsample(ChartImage{1, 1, false, false, 1, {7, 8, 9}}).rgb, (std::vector<uint8_t>{7, 8, 9}));
}

TEST(AtlasLayer, DownsampleKeepsTheMeanOfAnySize) {
    for (const uint32_t width : {1u, 3u, 6u, 7u}) {
        for (const uint32_t height : {1u, 2u, 5u, 9u}) {
            const ChartImage image = smooth_chart(width, height);
            const ChartImage coarse = downsample(image);
            const auto mean = [](const ChartImage& of) {
                double sum = 0;
                for (const uint8_t value : of.rgb) sum += static_cast<double>(linear_of_srgb(value));
                return sum / static_cast<double>(of.rgb.size());
            };
            constexpr double kHalfByte = 0.5 / 255 * 2.3;  // where the encoding is flattest
            EXPECT_NEAR(mean(image), mean(coarse), kHalfByte) << width << " x " << height;
        }
    }
}

TEST(AtlasLayer, EveryPrefixShowsEveryChartAtItsFinestMip) {
    const std::vector<ChartImage> charts = {smooth_chart(256, 128), smooth_chart(1, 1), smooth_chart(37, 5),
                                            smooth_chart(1, 64), smooth_chart(8, 8)};
    const LayerSteps steps = encode_atlas(charts);
    ASSERT_GT(steps.size(), 2u);
    for (size_t count = 1; count <= steps.size(); ++count) {
        const Prefix prefix = prefix_of(steps, count);
        const auto view = AtlasLayerView::create(prefix.words, prefix.step_words);
        ASSERT_TRUE(view.ok()) << view.error().text();
        EXPECT_EQ(view->chart_count(), 5u);
        EXPECT_EQ(view->finest_mip(), steps.size() - count);
        for (uint32_t chart = 0; chart < 5; ++chart) {
            ASSERT_LT(view->finest_mip(), view->mip_count(chart));
            EXPECT_EQ(view->width(chart), charts[chart].width);
            EXPECT_EQ(view->height(chart), charts[chart].height);
            EXPECT_EQ(view->flags(chart) & 3u, ATLAS_CHART_REPEAT_U);
            ChartImage mip = charts[chart];
            for (uint32_t m = 0; m < view->mip_count(chart); ++m, mip = downsample(mip)) {
                if (m < view->finest_mip()) continue;
                for (uint32_t y = 0; y < mip.height; ++y) {
                    for (uint32_t x = 0; x < mip.width; ++x) {
                        uint8_t rgb[3];
                        view->texel(chart, m, x, y, rgb);
                        // Half a third of the full range: the most that a block of greys can be off.
                        for (uint32_t c = 0; c < 3; ++c) {
                            ASSERT_LE(std::abs(rgb[c] - mip.rgb[3 * (y * mip.width + x) + c]), 43)
                                << chart << " mip " << m << " at " << x << " " << y;
                        }
                    }
                }
            }
        }
    }
}

TEST(AtlasLayer, StepZeroIsSmallAndErrorsFallByHalves) {
    const std::vector<ChartImage> charts = {smooth_chart(512, 512, 0.02f), smooth_chart(16, 16, 0.5f)};
    const LayerSteps steps = encode_atlas(charts);
    EXPECT_LE(steps[0].words.size(), 1024u + ATLAS_HEADER_WORDS + 2 * ATLAS_CHART_WORDS);
    EXPECT_GT(steps[0].words.size(), 512u) << "as many mips as fit";
    for (size_t s = 1; s < steps.size(); ++s) EXPECT_LE(steps[s].error, steps[s - 1].error);
    EXPECT_FLOAT_EQ(steps.back().error, 0.5f) << "the coarse chart is at its finest";
    const std::vector<ChartImage> coarse_alone = {smooth_chart(512, 512, 0.02f)};
    const LayerSteps alone = encode_atlas(coarse_alone);
    EXPECT_FLOAT_EQ(alone.back().error, 0.02f);
    EXPECT_FLOAT_EQ(alone[alone.size() - 2].error, 0.04f);
}

TEST(AtlasLayer, NoChartsIsAValidLayer) {
    const LayerSteps steps = encode_atlas({});
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].error, 0.0f);
    const Prefix prefix = prefix_of(steps, 1);
    const auto view = AtlasLayerView::create(prefix.words, prefix.step_words);
    ASSERT_TRUE(view.ok()) << view.error().text();
    EXPECT_EQ(view->chart_count(), 0u);
}

TEST(AtlasLayer, ManyChartsThatDoNotFitStepZeroStillEncode) {
    std::vector<ChartImage> charts(700, smooth_chart(4, 4));
    charts.push_back(smooth_chart(32, 8));
    const LayerSteps steps = encode_atlas(charts);
    EXPECT_EQ(steps.size(), 6u) << "the coarsest mip alone in step 0";
    const Prefix prefix = prefix_of(steps, 1);
    const auto view = AtlasLayerView::create(prefix.words, prefix.step_words);
    ASSERT_TRUE(view.ok()) << view.error().text();
    uint8_t rgb[3];
    view->texel(0, view->finest_mip(), 0, 0, rgb);
    EXPECT_NEAR(rgb[0], 110, 4) << "the mean of its light";
}

TEST(AtlasLayer, LargestSizesEncode) {
    const std::vector<ChartImage> charts = {smooth_chart(8192, 3), smooth_chart(1, 8192)};
    const LayerSteps steps = encode_atlas(charts);
    const Prefix prefix = prefix_of(steps, steps.size());
    const auto view = AtlasLayerView::create(prefix.words, prefix.step_words);
    ASSERT_TRUE(view.ok()) << view.error().text();
    EXPECT_EQ(view->mip_count(0), 14u);
    EXPECT_EQ(view->finest_mip(), 0u);
}

std::vector<ChartImage> golden_charts() {
    ChartImage white{5, 4, false, true, 1, std::vector<uint8_t>(60, 255)};
    ChartImage black{1, 1, true, true, 2, {0, 0, 0}};
    return {white, black};
}

TEST(AtlasLayer, GoldenWords) {
    const LayerSteps steps = encode_atlas(golden_charts());
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_FLOAT_EQ(steps[0].error, 2.0f);
    EXPECT_EQ(
        steps[0].words,
        (std::vector<uint32_t>{
            0x31415343u, 2,       3,           0,       8,           0, 0, 0,                          // header
            36,          32,      28,          0,       0,           0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  // mip table
            0x00040005u, 0x0302u, 0x00010001u, 0x0103u,                                                // charts
            2,           0,       0xffffffffu, 0,                                                      // mip 2: 1 x 1
            2,           0,       0xffffffffu, 0,                                                      // mip 1: 2 x 2
            2,           6,       0xffffffffu, 0,       0xffffffffu, 0, 0, 0}));  // mip 0: 5 x 4, and the black texel
}

TEST(AtlasLayer, RefusesEveryTruncationAndWrongStepWords) {
    const std::vector<ChartImage> charts = {smooth_chart(64, 64), smooth_chart(128, 16)};
    const LayerSteps steps = encode_atlas(charts);
    ASSERT_GT(steps.size(), 1u);
    const Prefix whole = prefix_of(steps, steps.size());
    for (size_t size = 0; size < whole.words.size(); ++size) {
        const auto cut = exact_copy(std::span(whole.words).first(size));
        EXPECT_FALSE(AtlasLayerView::create(cut, whole.step_words).ok()) << size;
        const uint32_t one_step[] = {static_cast<uint32_t>(size)};
        EXPECT_EQ(AtlasLayerView::create(cut, one_step).ok(), size >= whole.step_words[0]) << size;
    }
    std::vector<uint32_t> wrong = whole.step_words;
    ++wrong[0];
    EXPECT_FALSE(AtlasLayerView::create(whole.words, wrong).ok());
    --wrong[1];
    EXPECT_FALSE(AtlasLayerView::create(whole.words, wrong).ok()) << "a part begins before its step";
    EXPECT_FALSE(AtlasLayerView::create(whole.words, {}).ok());
    wrong = whole.step_words;
    wrong.resize(20, 0);
    EXPECT_FALSE(AtlasLayerView::create(whole.words, wrong).ok()) << "more steps than mips";
}

TEST(AtlasLayer, NoDamagedWordMakesATexelReadOutside) {
    const std::vector<ChartImage> charts = {smooth_chart(33, 20), smooth_chart(2, 2)};
    const LayerSteps steps = encode_atlas(charts);
    const Prefix whole = prefix_of(steps, steps.size());
    size_t accepted = 0;
    size_t refused = 0;
    unsigned sum = 0;
    for_each_mutation(whole.words, [&](std::span<const uint32_t> words) {
        const auto view = AtlasLayerView::create(words, whole.step_words);
        ++(view.ok() ? accepted : refused);
        if (!view.ok()) return;
        for (uint32_t chart = 0; chart < view->chart_count(); ++chart) {
            for (uint32_t mip = view->finest_mip(); mip < view->mip_count(chart); ++mip) {
                // The corners read the first and the last block.
                const uint32_t right = std::max(1u, view->width(chart) >> mip) - 1;
                const uint32_t top = std::max(1u, view->height(chart) >> mip) - 1;
                uint8_t rgb[3];
                view->texel(chart, mip, 0, 0, rgb);
                view->texel(chart, mip, right, top, rgb);
                sum += rgb[0];
            }
        }
    });
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
    EXPECT_GT(sum, 0u);
}

TEST(AtlasLayer, SameChartsGiveTheSameWords) {
    const std::vector<ChartImage> charts = {smooth_chart(99, 40), smooth_chart(7, 70)};
    const LayerSteps a = encode_atlas(charts);
    const LayerSteps b = encode_atlas(charts);
    ASSERT_EQ(a.size(), b.size());
    for (size_t s = 0; s < a.size(); ++s) EXPECT_EQ(a[s].words, b[s].words);
}

/// A shared chart, a black texel of the tile's own, another shared chart.
LayerSteps golden_shared() {
    const std::vector<ChartImage> own = {{1, 1, true, true, 2, {0, 0, 0}}};
    const std::vector<SharedChartUse> shared = {{0, 7, 0.05F}, {2, 300, 1.5F}};
    return encode_atlas(own, {}, shared);
}

TEST(AtlasLayer, SharedChartsAreNamedInTheirPlacesAndHaveNoBlocks) {
    const LayerSteps steps = golden_shared();
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_FLOAT_EQ(steps[0].error, 2.0f) << "of the tile's own";
    EXPECT_EQ(steps[0].words,
              (std::vector<uint32_t>{
                  0x31415343u, 3,           1,           0,       8,   0,           0, 0,  // header
                  30,          0,           0,           0,       0,   0,           0, 0,  // mip table
                  0,           0,           0,           0,       0,   0,           0, 0,  //
                  7,           0x3d4d0004u, 0x00010001u, 0x0103u, 300, 0x3fc00004u,        // charts
                  0,           3,           0,           0,       0}));  // mip 0: a black block for chart 1
    const Prefix prefix = prefix_of(steps, 1);
    const auto view = AtlasLayerView::create(prefix.words, prefix.step_words, 301);
    ASSERT_TRUE(view.ok()) << view.error().text();
    EXPECT_EQ(view->chart_count(), 3u);
    EXPECT_TRUE(view->is_shared(0));
    EXPECT_FALSE(view->is_shared(1));
    const float rounded = 0.05004882812F;
    EXPECT_EQ(view->shared_charts(), (std::vector<SharedChartUse>{{0, 7, rounded}, {2, 300, 1.5F}}));
    EXPECT_EQ(view->mip_count(0), 0u);
    EXPECT_EQ(view->mip_count(1), 1u);
    uint8_t rgb[3] = {1, 1, 1};
    view->texel(1, 0, 0, 0, rgb);
    EXPECT_EQ(rgb[0], 0);
}

TEST(AtlasLayer, NumbersBeyondTheDictionaryAreRefused) {
    const Prefix prefix = prefix_of(golden_shared(), 1);
    EXPECT_FALSE(AtlasLayerView::create(prefix.words, prefix.step_words, 300).ok());
    EXPECT_FALSE(AtlasLayerView::create(prefix.words, prefix.step_words).ok());
    const auto refused = [&](uint32_t word, uint32_t value) {
        Prefix damaged = prefix;
        damaged.words[word] = value;
        return !AtlasLayerView::create(damaged.words, damaged.step_words, 301).ok();
    };
    EXPECT_FALSE(refused(25, 0x00000004u)) << "a texel without extent";
    EXPECT_TRUE(refused(25, 0x3d4d0005u)) << "repeats: the dictionary says that";
    EXPECT_TRUE(refused(25, 0x3d4d0104u)) << "has a mip";
    EXPECT_TRUE(refused(25, 0x7f800004u)) << "infinite";
    EXPECT_TRUE(refused(25, 0x7fc00004u)) << "not a number";
    EXPECT_TRUE(refused(25, 0xbd4d0004u)) << "negative";
    EXPECT_TRUE(refused(27, 0x3d4d0103u)) << "metres of a chart of the tile's own";
    EXPECT_TRUE(refused(30, 3)) << "blocks of a shared chart";
}

TEST(AtlasLayer, SharedChartsOnlyAreOneStepWithoutError) {
    const std::vector<SharedChartUse> shared = {{0, 0, 0.25F}, {1, 5, 4}};
    const LayerSteps steps = encode_atlas({}, {}, shared);
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].error, 0.0f);
    const Prefix prefix = prefix_of(steps, 1);
    const auto view = AtlasLayerView::create(prefix.words, prefix.step_words, 6);
    ASSERT_TRUE(view.ok()) << view.error().text();
    EXPECT_EQ(view->shared_charts(), shared);
}

TEST(AtlasLayer, SharedChartsLeaveTheMipsOfOthersAsTheyAre) {
    const std::vector<ChartImage> own = {smooth_chart(128, 64), smooth_chart(3, 9)};
    const std::vector<SharedChartUse> shared = {{1, 2, 1}};
    const LayerSteps alone = encode_atlas(own), mixed = encode_atlas(own, {}, shared);
    ASSERT_EQ(alone.size(), mixed.size());
    const Prefix a = prefix_of(alone, alone.size()), b = prefix_of(mixed, mixed.size());
    const auto view_a = AtlasLayerView::create(a.words, a.step_words);
    const auto view_b = AtlasLayerView::create(b.words, b.step_words, 3);
    ASSERT_TRUE(view_b.ok()) << view_b.error().text();
    for (uint32_t chart = 0; chart < 2; ++chart) {
        for (uint32_t x = 0; x < own[chart].width; ++x) {
            uint8_t rgb_a[3], rgb_b[3];
            view_a->texel(chart, 0, x, x / 2, rgb_a);
            view_b->texel(2 * chart, 0, x, x / 2, rgb_b);
            ASSERT_EQ(rgb_a[0], rgb_b[0]) << chart << " at " << x;
        }
    }
    for (size_t step = 0; step < alone.size(); ++step) EXPECT_EQ(alone[step].error, mixed[step].error);
}

TEST(AtlasLayer, NoDamagedWordOfATileWithSharedChartsNamesOneThatIsNotThere) {
    const Prefix whole = prefix_of(golden_shared(), 1);
    size_t accepted = 0;
    for_each_mutation(whole.words, [&](std::span<const uint32_t> words) {
        const auto view = AtlasLayerView::create(words, whole.step_words, 301);
        if (!view.ok()) return;
        ++accepted;
        for (const SharedChartUse& use : view->shared_charts()) {
            ASSERT_LT(use.chart_in_tile, view->chart_count());
            ASSERT_LT(use.number, 301u);
            ASSERT_GE(use.metres_per_texel, 0);
        }
        for (uint32_t chart = 0; chart < view->chart_count(); ++chart) {
            uint8_t rgb[3];
            for (uint32_t mip = view->finest_mip(); mip < view->mip_count(chart); ++mip)
                view->texel(chart, mip, 0, 0, rgb);
        }
    });
    EXPECT_GT(accepted, 0u);
}

}  // namespace
}  // namespace citystream::codec::atlas
