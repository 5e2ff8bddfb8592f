// Charts with alpha in an atlas layer, on the wire and in the dictionary.
#include <gtest/gtest.h>

#include <cstring>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/atlas_packing.h"
#include "codec/atlas/shared_chart.h"
#include "codec/step_wire.h"

namespace citystream::codec::atlas {
namespace {

/// Smooth colours with round holes.
ChartImage holes(uint32_t width, uint32_t height, bool alpha = true) {
    ChartImage image{width, height, true, false, 0.05F, {}, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const int dx = static_cast<int>(x % 16) - 8, dy = static_cast<int>(y % 16) - 8;
            image.rgb.insert(image.rgb.end(),
                             {static_cast<uint8_t>(40 + x % 128), static_cast<uint8_t>(200 - y % 128), 90});
            if (alpha) image.alpha.push_back(dx * dx + dy * dy < 30 ? 0 : 255);
        }
    }
    return image;
}

std::vector<uint32_t> joined(const LayerSteps& steps, size_t count) {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < count; ++i) words.insert(words.end(), steps[i].words.begin(), steps[i].words.end());
    return words;
}

std::vector<uint32_t> sizes(const LayerSteps& steps, size_t count) {
    std::vector<uint32_t> words;
    for (size_t i = 0; i < count; ++i) words.push_back(static_cast<uint32_t>(steps[i].words.size()));
    return words;
}

TEST(AlphaChart, HasItsAlphaAtEveryMipAndTheOthersHaveNone) {
    const std::vector<ChartImage> charts = {holes(128, 64, false), holes(200, 96), holes(64, 64, false), holes(5, 3)};
    const LayerSteps steps = encode_atlas(charts);
    ASSERT_GT(steps.size(), 1u);
    for (size_t count = 1; count <= steps.size(); ++count) {
        const auto words = joined(steps, count);
        const auto view = AtlasLayerView::create(words, sizes(steps, count));
        ASSERT_TRUE(view.ok()) << view.error().text();
        for (uint32_t chart = 0; chart < 4; ++chart) {
            EXPECT_EQ(view->has_alpha(chart), !charts[chart].alpha.empty());
            ChartImage mip = charts[chart];
            for (uint32_t m = 0; m < view->mip_count(chart); ++m, mip = downsample(mip)) {
                if (m < view->finest_mip()) continue;
                for (uint32_t y = 0; y < mip.height; ++y) {
                    for (uint32_t x = 0; x < mip.width; ++x) {
                        const size_t i = size_t{y} * mip.width + x;
                        const int wanted = mip.alpha.empty() ? 255 : mip.alpha[i];
                        ASSERT_NEAR(view->alpha(chart, m, x, y), wanted, 26) << chart << " " << m;
                        uint8_t rgb[3];
                        view->texel(chart, m, x, y, rgb);
                        ASSERT_NEAR(rgb[0], mip.rgb[3 * i], 40);
                    }
                }
            }
        }
    }
}

TEST(AlphaChart, EndsAtTheLastMipThatCanBeThereInPart) {
    const std::vector<ChartImage> charts = {holes(256, 64)};
    const LayerSteps steps = encode_atlas(charts);
    const auto words = joined(steps, steps.size());
    const auto view = AtlasLayerView::create(words, sizes(steps, steps.size()));
    ASSERT_TRUE(view.ok());
    EXPECT_EQ(view->mip_count(0), 5u) << "16 x 4 is the last one of 64 texels";
    const std::vector<ChartImage> tiny = {holes(3, 3)};
    EXPECT_EQ(AtlasLayerView::create(encode_atlas(tiny)[0].words, sizes(encode_atlas(tiny), 1))->mip_count(0), 1u);
}

TEST(AlphaChart, OpaqueChartsAreTheSameBytesBesideIt) {
    const std::vector<ChartImage> alone = {holes(64, 64, false)}, both = {holes(64, 64, false), holes(64, 64)};
    const LayerSteps a = encode_atlas(alone), b = encode_atlas(both);
    const auto words = joined(b, b.size());
    const auto view = AtlasLayerView::create(words, sizes(b, b.size()));
    const auto plain = AtlasLayerView::create(a[0].words, sizes(a, 1));
    ASSERT_TRUE(view.ok());
    ASSERT_TRUE(plain.ok());
    for (uint32_t i = 0; i < 64 * 64; ++i) {
        uint8_t left[3], right[3];
        view->texel(0, 0, i % 64, i / 64, left);
        plain->texel(0, 0, i % 64, i / 64, right);
        ASSERT_EQ(std::vector(left, left + 3), std::vector(right, right + 3));
    }
    EXPECT_EQ(plain->flags(0) & ATLAS_CHART_ALPHA, 0u);
}

TEST(AlphaChart, RefusesBlocksThatOnlyBc1WouldHold) {
    const std::vector<ChartImage> charts = {holes(16, 16, false)};
    LayerSteps steps = encode_atlas(charts);
    ASSERT_TRUE(AtlasLayerView::create(steps[0].words, sizes(steps, 1)).ok());
    steps[0].words[ATLAS_HEADER_WORDS + ATLAS_CHART_FLAGS] |= ATLAS_CHART_ALPHA;
    EXPECT_FALSE(AtlasLayerView::create(steps[0].words, sizes(steps, 1)).ok());
}

TEST(AlphaChart, GoldenWords) {
    ChartImage post{4, 4, true, false, 1, {}, {}};
    for (int i = 0; i < 16; ++i) {
        post.rgb.insert(post.rgb.end(), {255, 255, 255});
        post.alpha.push_back(i % 4 < 2 ? 255 : 0);
    }
    const std::vector<ChartImage> charts = {post, {1, 1, true, true, 2, {0, 0, 0}}};
    const LayerSteps steps = encode_atlas(charts);
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].words,
              (std::vector<uint32_t>{0x31415343u, 2,           1,           0,       8, 0, 0, 0,  // header
                                     28,          0,           0,           0,       0, 0, 0, 0,  // mip table
                                     0,           0,           0,           0,       0, 0, 0, 0,  //
                                     0x00040004u, 0x00000109u, 0x00010001u, 0x0103u,              // charts
                                     4,           2,           0,           0,  // offsets: the black block comes first
                                     0xf03f0000u, 0x03f03f03u, 0xffffffffu, 0}));
    const auto packed = pack_atlas_step(steps[0].words, 0, steps[0].words);
    ASSERT_TRUE(packed);
    std::vector<uint32_t> words(packed->size() / 4);
    std::memcpy(words.data(), packed->data(), packed->size());
    EXPECT_EQ(words[0], 0x51415343u);
    EXPECT_EQ((std::vector<uint32_t>(words.begin() + 1, words.begin() + 5)), (std::vector<uint32_t>{1, 30, 1, 1}))
        << "one run: its table, a BC1 block, a BC3 block";
}

TEST(AlphaChart, TravelsPackedAndComesBack) {
    const std::vector<ChartImage> charts = {holes(300, 64), holes(128, 64, false), holes(70, 90)};
    const LayerSteps steps = encode_atlas(charts);
    const auto frames = encode_steps(steps, 5);
    for (uint32_t i = 0; i < steps.size(); ++i) {
        const auto packed = pack_atlas_step(steps[0].words, i, steps[i].words);
        ASSERT_TRUE(packed);
        EXPECT_TRUE(is_packed_atlas(*packed));
        EXPECT_LE(packed->size(), most_packed_atlas_bytes(steps[i].words.size()));
        const auto words = unpack_atlas_step(*packed, steps[i].words.size());
        ASSERT_TRUE(words.ok());
        EXPECT_EQ(*words, steps[i].words);
        const auto decoded = decode_step(frames[i], 4 * steps[i].words.size());
        ASSERT_TRUE(decoded.ok());
        EXPECT_EQ(*decoded, steps[i].words);
        for (size_t size = 0; size < packed->size(); size += 3)
            EXPECT_FALSE(unpack_atlas_step(std::span(*packed).first(size), steps[i].words.size()).ok());
    }
}

TEST(AlphaChart, IsSharedLikeAnyOther) {
    constexpr uint32_t kFlags = ATLAS_CHART_REPEAT_U | ATLAS_CHART_ALPHA;
    for (const auto& [width, height] : {std::pair{200U, 90U}, {12U, 9U}, {1U, 1U}, {640U, 32U}}) {
        const std::vector<ChartImage> chart = {holes(width, height)};
        const LayerSteps steps = encode_atlas(chart);
        ASSERT_EQ(atlas_step_count(width, height, kFlags), steps.size());
        const auto payloads = encode_chart_levels(steps);
        for (uint32_t step = 0; step < steps.size(); ++step) {
            EXPECT_EQ(atlas_step_words(width, height, kFlags, step), steps[step].words.size());
            const auto words = decode_chart_level(payloads[step], width, height, kFlags, step);
            ASSERT_TRUE(words.ok()) << words.error().text();
            EXPECT_EQ(*words, steps[step].words);
            const auto prefix = joined(steps, step + 1);
            const auto view = shared_chart_view(prefix, width, height, kFlags, step + 1);
            ASSERT_TRUE(view.ok()) << view.error().text();
            EXPECT_TRUE(view->has_alpha(0));
            if (step < atlas_step_count(width, height, ATLAS_CHART_REPEAT_U)) {
                EXPECT_FALSE(shared_chart_view(prefix, width, height, ATLAS_CHART_REPEAT_U, step + 1).ok());
            }
        }
    }
    EXPECT_GT(atlas_step_count(8192, 8192, kFlags), kMostChartLevels) << "such a chart is not shared";
    EXPECT_LE(atlas_step_count(4096, 4096, kFlags), kMostChartLevels);
}

}  // namespace
}  // namespace citystream::codec::atlas
