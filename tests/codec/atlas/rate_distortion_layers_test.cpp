// Atlases of both forms whose blocks are chosen for the bytes that they travel in: what a chart may do to the others of
// its step, and that nothing but the charts decides.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/bc1_rate.h"
#include "codec/atlas/page_layer.h"
#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

constexpr uint32_t kStrength = 64;
constexpr uint64_t kMostRise = uint64_t{16} * Bc1RateOptions().most_rise_per_texel;  // of a block
constexpr size_t kEdited = 5, kCharts = 10;

std::vector<ChartImage> some_charts() {
    std::vector<ChartImage> charts;
    for (uint32_t i = 0; i < kCharts; ++i) {
        const uint32_t side = 32 + 16 * (i % 3);
        charts.push_back(chart_image(sample::with_noise(sample::facade(side, side, 8 + i), 12, i)));
        charts.back().metres_per_texel = 0.1F;
    }
    return charts;
}

std::vector<ChartImage> edited(std::vector<ChartImage> charts) {
    for (uint8_t& value : charts[kEdited].rgb) value = static_cast<uint8_t>(255 - value);
    return charts;
}

/// A form of atlas: its steps, and the texels of every chart's finest mip as they are shown.
struct Form {
    const char* name;
    std::function<LayerSteps(const std::vector<ChartImage>&, uint32_t strength)> encode;
    std::function<void(std::span<const uint32_t>, std::span<const uint32_t>, std::vector<ChartImage>&)> show;
};

void show_charts(std::span<const uint32_t> words, std::span<const uint32_t> steps, std::vector<ChartImage>& charts) {
    const auto view = AtlasLayerView::create(words, steps).value();
    for (uint32_t i = 0; i < charts.size(); ++i) {
        for (uint32_t t = 0; t < charts[i].width * charts[i].height; ++t)
            view.texel(i, 0, t % charts[i].width, t / charts[i].width, &charts[i].rgb[size_t{3} * t]);
    }
}

void show_pages(std::span<const uint32_t> words, std::span<const uint32_t> steps, std::vector<ChartImage>& charts) {
    const auto view = PageLayerView::create(words, steps).value();
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const PageChart chart = view.chart(i);
        const WrapAxis u = decode_wrap_axis(chart.packed.u, view.border()),
                       v = decode_wrap_axis(chart.packed.v, view.border());
        for (uint32_t t = 0; t < charts[i].width * charts[i].height; ++t)
            view.texel(chart.page, 0, u.origin + t % charts[i].width, v.origin + t / charts[i].width,
                       &charts[i].rgb[size_t{3} * t]);
    }
}

const Form kForms[] = {{"charts",
                        [](const std::vector<ChartImage>& charts, uint32_t strength) {
                            return encode_atlas(charts, {.rate_distortion = strength});
                        },
                        show_charts},
                       {"pages",
                        [](const std::vector<ChartImage>& charts, uint32_t strength) {
                            return encode_pages(charts, {.rate_distortion = strength}).value();
                        },
                        show_pages}};

std::vector<ChartImage> shown(const Form& form, const std::vector<ChartImage>& charts, uint32_t strength) {
    std::vector<uint32_t> words, steps;
    for (const LayerStep& step : form.encode(charts, strength)) {
        words.insert(words.end(), step.words.begin(), step.words.end());
        steps.push_back(static_cast<uint32_t>(step.words.size()));
    }
    std::vector<ChartImage> pictures = charts;
    form.show(words, steps, pictures);
    return pictures;
}

/// Squared error of four by four texels.
uint64_t block_error(const ChartImage& wanted, const ChartImage& seen, uint32_t x, uint32_t y) {
    uint64_t error = 0;
    for (uint32_t row = y; row < y + 4; ++row) {
        for (uint32_t i = 3 * (row * wanted.width + x); i < 3 * (row * wanted.width + x + 4); ++i) {
            const int difference = wanted.rgb[i] - seen.rgb[i];
            error += static_cast<uint64_t>(difference * difference);
        }
    }
    return error;
}

class RateDistortionLayers : public testing::TestWithParam<size_t> {
  protected:
    const Form& form() const { return kForms[GetParam()]; }
};

// Of charts: pages stretch theirs, so that their blocks have nothing to be compared with.
TEST(RateDistortionCharts, EditingOneTakesNoBlockOfAnotherBeyondTheStatedLoss) {
    const Form& form = kForms[0];
    const auto before = some_charts(), after = edited(before);
    const auto best = shown(form, before, 0), first = shown(form, before, kStrength),
               second = shown(form, after, kStrength);
    size_t coarser = 0;
    for (size_t i = 0; i < kCharts; ++i) {
        const ChartImage& wanted = before[i];
        if (i == kEdited) {
            EXPECT_NE(first[i].rgb, second[i].rgb);
            continue;
        }
        for (uint32_t y = 0; y < wanted.height; y += 4) {
            for (uint32_t x = 0; x < wanted.width; x += 4) {
                const uint64_t most = block_error(wanted, best[i], x, y) + kMostRise;
                ASSERT_LE(block_error(wanted, first[i], x, y), most) << i << ' ' << x << ' ' << y;
                ASSERT_LE(block_error(wanted, second[i], x, y), most) << i << ' ' << x << ' ' << y;
                coarser += block_error(wanted, second[i], x, y) > block_error(wanted, best[i], x, y) ? 1 : 0;
            }
        }
    }
    EXPECT_GT(coarser, 100U) << "no block yields anything: the test is too easy";
}

TEST_P(RateDistortionLayers, WithoutItEditingAChartChangesNoTexelOfAnother) {
    const auto before = some_charts();
    const auto first = shown(form(), before, 0), second = shown(form(), edited(before), 0);
    for (size_t i = 0; i < kCharts; ++i) EXPECT_EQ(first[i].rgb == second[i].rgb, i != kEdited) << i;
}

TEST_P(RateDistortionLayers, TheSameChartsGiveTheSameWords) {
    const auto charts = some_charts();
    const LayerSteps a = form().encode(charts, kStrength), b = form().encode(charts, kStrength),
                     best = form().encode(charts, 0);
    ASSERT_EQ(a.size(), b.size());
    for (size_t s = 0; s < a.size(); ++s) EXPECT_EQ(a[s].words, b[s].words);
    EXPECT_NE(a.back().words, best.back().words);
}

INSTANTIATE_TEST_SUITE_P(Forms, RateDistortionLayers, testing::Range(size_t{0}, std::size(kForms)),
                         [](const auto& form) { return std::string(kForms[form.param].name); });

}  // namespace
}  // namespace citystream::codec::atlas
