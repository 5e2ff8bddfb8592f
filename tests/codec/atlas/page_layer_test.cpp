#include "codec/atlas/page_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "codec/atlas/bc1.h"
#include "codec/step_wire.h"
#include "tests/codec/atlas/rectangle_sets.h"
#include "tests/shaders/page_sample_on_cpu.h"

namespace citystream::codec::atlas {
namespace {

using tests::Dice;

ChartImage chart_of(uint32_t width, uint32_t height, bool repeat, float texel = 0.1F) {
    return {width, height, repeat, repeat, texel, std::vector<uint8_t>(size_t{3} * width * height)};
}

ChartImage pure(uint32_t width, uint32_t height, const std::array<uint8_t, 3>& rgb, const std::array<uint8_t, 3>& dot) {
    ChartImage chart = chart_of(width, height, true);
    for (size_t i = 0; i < chart.rgb.size(); ++i) chart.rgb[i] = rgb[i % 3];
    // One texel of another colour, so that it is no flat chart.
    std::copy(dot.begin(), dot.end(), chart.rgb.begin() + 3 * (width * (height / 2) + width / 2));
    return chart;
}

/// Smooth, and periodic where it repeats: what BC1 keeps well.
ChartImage waves(uint32_t width, uint32_t height, bool repeat, uint32_t seed, double contrast = 1) {
    ChartImage chart = chart_of(width, height, repeat);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const double u = 2 * M_PI * x / width, v = 2 * M_PI * y / height;
            const double wave = std::sin(u + seed) * 0.5 + std::cos(v + 2.0 * seed) * 0.5;
            uint8_t* texel = &chart.rgb[3 * (size_t{y} * width + x)];
            for (size_t c = 0; c < 3; ++c)
                texel[c] = static_cast<uint8_t>(128 + wave * contrast * (40 + 20 * static_cast<double>(c)));
        }
    }
    return chart;
}

struct Prefix {
    std::vector<uint32_t> words, steps;
};

Prefix prefix_of(const LayerSteps& steps, size_t count) {
    Prefix prefix;
    for (size_t i = 0; i < count; ++i) {
        prefix.words.insert(prefix.words.end(), steps[i].words.begin(), steps[i].words.end());
        prefix.steps.push_back(static_cast<uint32_t>(steps[i].words.size()));
    }
    return prefix;
}

Prefix encoded(std::span<const ChartImage> charts, const PageOptions& options = {}) {
    const auto steps = encode_pages(charts, options);
    if (!steps) throw std::runtime_error(steps.error().text());
    return prefix_of(*steps, steps->size());
}

std::vector<ChartImage> some_waves(size_t count, uint64_t seed) {
    Dice dice(seed);
    std::vector<ChartImage> charts;
    for (size_t i = 0; i < count; ++i)
        charts.push_back(waves(dice.roll(1, 90), dice.roll(1, 90), dice.roll(0, 1) == 0, static_cast<uint32_t>(i)));
    return charts;
}

/// How fast places change where a level of this chart is what a pixel covers.
std::array<float, 2> change_for_level(const PageLayerView& view, const PageChart& chart, float level) {
    const ChartFrame frame = frame_of(chart.packed, view.border());
    return {std::exp2(level) / frame.size_u, 0};
}

TEST(PageLayer, WordsAreThoseOfTheExampleOfTheFormatPage) {
    const std::vector<ChartImage> charts = {{2, 2, true, false, 0.5F, {255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 255, 255}},
                                            {1, 1, true, true, 0, {16, 32, 48}}};
    const auto steps = encode_pages(charts, {0});
    ASSERT_TRUE(steps.ok());
    ASSERT_EQ(steps->size(), 1U);
    EXPECT_EQ((*steps)[0].error, 0.5F);
    const std::vector<uint32_t> words = {0x31505343, 2, 1, 0x100, 0x40004, 0x13,     0, 0, 0,      0,         0,
                                         0,          0, 0, 0,     1,       0x302010, 0, 7, 0xffff, 0x44441111};
    EXPECT_EQ((*steps)[0].words, words);
}

TEST(PageLayer, EveryPrefixIsACoarserVersionOfAllCharts) {
    const auto charts = some_waves(40, 1);
    const auto steps = encode_pages(charts);
    ASSERT_TRUE(steps.ok());
    ASSERT_EQ(steps->size(), 3U);
    for (size_t count = 1; count <= 3; ++count) {
        const Prefix prefix = prefix_of(*steps, count);
        const auto view = PageLayerView::create(prefix.words, prefix.steps);
        ASSERT_TRUE(view.ok()) << view.error().text();
        EXPECT_EQ(view->chart_count(), 40U);
        EXPECT_EQ(view->finest_mip(), 3 - count);
        EXPECT_FLOAT_EQ((*steps)[count - 1].error, std::ldexp(0.1F, static_cast<int>(3 - count)));
    }
}

TEST(PageLayer, ShowsTheChartsWithinTheLossOfTheirBlocks) {
    const auto charts = some_waves(60, 2);
    const Prefix prefix = encoded(charts);
    const auto view = PageLayerView::create(prefix.words, prefix.steps);
    ASSERT_TRUE(view.ok());
    double sum = 0, count = 0;
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const PageChart chart = view->chart(i);
        if (chart.flat) continue;
        const ChartFrame frame = frame_of(chart.packed, view->border());
        // Charts that alignment enlarged are compared where a texel of theirs lies.
        for (uint32_t y = 0; y < charts[i].height; ++y) {
            for (uint32_t x = 0; x < charts[i].width; ++x) {
                const std::array<float, 2> place = {
                    (static_cast<float>(x) + 0.5F) / static_cast<float>(charts[i].width),
                    (static_cast<float>(y) + 0.5F) / static_cast<float>(charts[i].height)};
                const auto rgb = shaders_test::sample_paged_on_cpu(prefix.words, i, place, {1e-6F, 0}, {0, 1e-6F}, 0);
                for (size_t c = 0; c < 3; ++c) {
                    const double original = charts[i].rgb[3 * (size_t{y} * charts[i].width + x) + c];
                    sum += std::pow(255 * static_cast<double>(rgb[c]) - original, 2);
                    ++count;
                }
            }
        }
        EXPECT_GE(frame.size_u, static_cast<float>(charts[i].width));
        EXPECT_GE(frame.size_v, static_cast<float>(charts[i].height));
    }
    const double psnr = 10 * std::log10(255 * 255 / (sum / count));
    EXPECT_GT(psnr, 38);
}

TEST(PageLayer, NoChartShowsAnothersColourAtAnyLevel) {
    // Pure red, green and blue side by side, in all sizes.
    for (const uint32_t mips : {0U, 1U, 2U, 3U}) {
        Dice dice(mips + 3);
        std::vector<ChartImage> charts;
        for (size_t i = 0; i < 60; ++i) {
            std::array<uint8_t, 3> rgb{}, dot{};
            rgb[i % 3] = 255;
            dot[i % 3] = 214;
            charts.push_back(pure(dice.roll(2, 40), dice.roll(2, 40), rgb, dot));
            charts.back().repeat_u = i % 2 == 0;
            charts.back().repeat_v = i % 4 < 2;
        }
        const Prefix prefix = encoded(charts, {mips});
        const auto view = PageLayerView::create(prefix.words, prefix.steps);
        ASSERT_TRUE(view.ok());
        for (uint32_t i = 0; i < charts.size(); ++i) {
            for (int sample = 0; sample < 200; ++sample) {
                const float level = static_cast<float>(dice.roll(0, 100 * mips)) / 100;
                const std::array<float, 2> place = {static_cast<float>(dice.roll(0, 4000)) / 1000 - 1,
                                                    static_cast<float>(dice.roll(0, 4000)) / 1000 - 1};
                const auto rgb = shaders_test::sample_paged_on_cpu(
                    prefix.words, i, place, change_for_level(*view, view->chart(i), level), {0, 0}, 0);
                for (size_t c = 0; c < 3; ++c) {
                    if (c == i % 3) continue;
                    EXPECT_LE(rgb[c], 1.0F / 255) << "chart " << i << " level " << level;
                }
                EXPECT_GE(rgb[i % 3], 200.0F / 255);
            }
        }
    }
}

TEST(PageLayer, SevenByFiveRepeatsLookLikeATextureThatRepeats) {
    const ChartImage chart = waves(60, 44, true, 5);  // interiors that are already aligned: 64 - 4, 48 - 4
    std::vector<ChartImage> charts = some_waves(20, 8);
    charts.push_back(chart);
    const Prefix prefix = encoded(charts);
    const auto view = PageLayerView::create(prefix.words, prefix.steps);
    ASSERT_TRUE(view.ok());
    const uint32_t index = 20;
    const auto own = view->chart(index);
    const WrapAxis u = decode_wrap_axis(own.packed.u, view->border()),
                   v = decode_wrap_axis(own.packed.v, view->border());
    ASSERT_EQ(u.size, 60U);
    ASSERT_EQ(v.size, 44U);
    const auto texel = [&](int64_t x, int64_t y, size_t c) {
        uint8_t rgb[3];
        view->texel(own.page, 0, u.origin + static_cast<uint32_t>((x % 60 + 60) % 60),
                    v.origin + static_cast<uint32_t>((y % 44 + 44) % 44), rgb);
        return rgb[c] / 255.0;
    };
    uint64_t differing = 0, samples = 0;
    double most = 0;
    for (uint32_t j = 0; j < 5 * 512; j += 7) {
        for (uint32_t i = 0; i < 7 * 512; i += 11) {
            const std::array<float, 2> place = {static_cast<float>(i) / 512, static_cast<float>(j) / 512};
            const auto rgb = shaders_test::sample_paged_on_cpu(prefix.words, index, place, {1e-6F, 0}, {0, 1e-6F}, 0);
            const double x = i / 512.0 * 60 - 0.5, y = j / 512.0 * 44 - 0.5;
            const auto x0 = static_cast<int64_t>(std::floor(x)), y0 = static_cast<int64_t>(std::floor(y));
            const double fx = x - std::floor(x), fy = y - std::floor(y);
            for (size_t c = 0; c < 3; ++c) {
                const double low = texel(x0, y0, c) * (1 - fx) + texel(x0 + 1, y0, c) * fx;
                const double high = texel(x0, y0 + 1, c) * (1 - fx) + texel(x0 + 1, y0 + 1, c) * fx;
                const double difference = std::abs(low * (1 - fy) + high * fy - static_cast<double>(rgb[c]));
                most = std::max(most, difference);
                differing += difference > 1.0 / 255 ? 1 : 0;
                ++samples;
            }
        }
    }
    // The border's blocks are not the interior's: where the seam is, they may differ by what BC1 loses.
    EXPECT_LE(static_cast<double>(differing), 0.001 * static_cast<double>(samples));
    EXPECT_LE(most, 4.0 / 255);
}

TEST(PageLayer, TheSeamOfARepeatIsSeamlessAtEveryLevel) {
    std::vector<ChartImage> charts = some_waves(20, 9);
    // Little contrast: what the blocks at either end of the seam lose is a step of a 5-bit channel.
    charts.push_back(waves(60, 60, true, 3, 0.25));
    const Prefix prefix = encoded(charts);
    const auto view = PageLayerView::create(prefix.words, prefix.steps);
    ASSERT_TRUE(view.ok());
    for (const float level : {0.0F, 0.5F, 1.0F, 1.7F, 2.0F}) {
        const auto change = change_for_level(*view, view->chart(20), level);
        for (float v = 0; v < 1; v += 0.0371F) {
            const auto before = shaders_test::sample_paged_on_cpu(prefix.words, 20, {0.99999F, v}, change, {0, 0}, 0);
            const auto behind = shaders_test::sample_paged_on_cpu(prefix.words, 20, {1.00001F, v}, change, {0, 0}, 0);
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(before[c], behind[c], 8.0 / 255) << level;
        }
    }
}

TEST(PageLayer, EditingAChartChangesNoBlockOfAnother) {
    std::vector<ChartImage> charts = some_waves(30, 10);
    for (ChartImage& chart : charts) chart.rgb[0] ^= 255;  // none is flat
    const Prefix before = encoded(charts);
    for (uint8_t& value : charts[7].rgb) value = static_cast<uint8_t>(255 - value);
    const Prefix after = encoded(charts);
    const auto a = PageLayerView::create(before.words, before.steps),
               b = PageLayerView::create(after.words, after.steps);
    ASSERT_TRUE(a.ok() && b.ok());
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const PageChart chart = a->chart(i);
        EXPECT_EQ(chart.packed, b->chart(i).packed);
        const WrapAxis u = decode_wrap_axis(chart.packed.u, 0), v = decode_wrap_axis(chart.packed.v, 0);
        bool changed = false;
        for (uint32_t mip = 0; mip <= 2; ++mip) {
            for (uint32_t y = v.origin >> mip; y < (v.origin + v.size) >> mip; ++y) {
                for (uint32_t x = u.origin >> mip; x < (u.origin + u.size) >> mip; ++x) {
                    uint8_t one[3], other[3];
                    a->texel(chart.page, mip, x, y, one);
                    b->texel(chart.page, mip, x, y, other);
                    changed = changed || !std::equal(one, one + 3, other);
                }
            }
        }
        EXPECT_EQ(changed, i == 7);
    }
}

TEST(PageLayer, FlatChartsTakeNoTexel) {
    const ChartImage flat{3, 5, true, true, 0.5F, std::vector<uint8_t>(45, 77)};
    const std::vector<ChartImage> charts(5, flat);
    const auto steps = encode_pages(charts);
    ASSERT_TRUE(steps.ok());
    ASSERT_EQ(steps->size(), 1U);
    EXPECT_EQ((*steps)[0].error, 0);
    const Prefix prefix = prefix_of(*steps, 1);
    const auto view = PageLayerView::create(prefix.words, prefix.steps);
    ASSERT_TRUE(view.ok());
    EXPECT_EQ(view->page_count(), 0U);
    const auto rgb = shaders_test::sample_paged_on_cpu(prefix.words, 4, {9.25F, 3}, {1, 0}, {0, 1}, 0);
    for (const float value : rgb) EXPECT_FLOAT_EQ(value, 77.0F / 255);
}

TEST(PageLayer, MipsAreAsManyAsChartsAreLargeEnoughFor) {
    const auto mips_for = [](uint32_t side, uint32_t count) {
        std::vector<ChartImage> charts;
        for (uint32_t i = 0; i < count; ++i) charts.push_back(waves(side, side, true, i));
        charts.push_back(pure(1, 1, {1, 2, 3}, {1, 2, 3}));
        return affordable_mips(charts, kMostMips);
    };
    EXPECT_EQ(mips_for(16, 5), 3u) << "32 x 32 with borders and alignment; of 4 mips 64 x 64";
    EXPECT_EQ(mips_for(64, 5), 5u) << "128 x 128; of 6 mips 256 x 256";
    EXPECT_EQ(mips_for(256, 2), 7u);
    EXPECT_EQ(affordable_mips({}, 3), 3u) << "flat charts take no room";
    const std::vector<ChartImage> large = {waves(256, 256, true, 1)};
    EXPECT_EQ(affordable_mips(large, 2), 2u) << "never more than asked for";
    const std::vector<ChartImage> tiny = {pure(2, 2, {1, 2, 3}, {9, 9, 9})};
    EXPECT_EQ(affordable_mips(tiny, 7), 3u) << "which all are given";
}

TEST(PageLayer, ChartsThatACoordinateCannotSayAreShrunkAndSaySo) {
    EXPECT_EQ(longest_page_chart(2), 508U);
    EXPECT_EQ(longest_page_chart(0), 510U);
    const std::vector<ChartImage> charts = {waves(2048, 16, false, 1), waves(16, 16, false, 2)};
    const auto steps = encode_pages(charts);
    ASSERT_TRUE(steps.ok());
    EXPECT_NEAR(steps->back().error, 0.1 * 2048 / 508, 1e-4);
}

TEST(PageLayer, SetsLargerThanAPageTakeSeveral) {
    std::vector<ChartImage> charts;
    for (uint32_t i = 0; i < 40; ++i) charts.push_back(waves(100, 100, true, i));
    const Prefix prefix = encoded(charts, {2, 0, 256});
    const auto view = PageLayerView::create(prefix.words, prefix.steps);
    ASSERT_TRUE(view.ok());
    EXPECT_GT(view->page_count(), 5U);
    EXPECT_FALSE(encode_pages(charts, {2, 0, 260}).ok());
    EXPECT_FALSE(encode_pages(charts, {8, 0, 4096}).ok());
}

/// Every chart asked for at texels of this length.
Prefix powers_of_two(std::span<const ChartImage> charts, float asked, const PageOptions& options = {}) {
    PageOptions with = options;
    with.shape = PageShape::kPowerOfTwo;
    const auto steps = encode_pages(charts, with, std::vector<float>(charts.size(), asked));
    if (!steps) throw std::runtime_error(steps.error().text());
    EXPECT_LE(steps->back().error, std::max(asked, 0.1F) * 1.0001F);
    return prefix_of(*steps, steps->size());
}

std::array<uint32_t, 2> size_of(const PageLayerView& view, uint32_t chart) {
    const PackedCoordinate packed = view.chart(chart).packed;
    return {static_cast<uint32_t>(decode_wrap_axis(packed.u, view.border()).size),
            static_cast<uint32_t>(decode_wrap_axis(packed.v, view.border()).size)};
}

uint64_t page_texels(const PageLayerView& view) {
    uint64_t texels = 0;
    for (uint32_t page = 0; page < view.page_count(); ++page) texels += uint64_t{view.width(page)} * view.height(page);
    return texels;
}

TEST(PageLayer, EveryTexelOfPagesThatArePowersOfTwoIsAChartsOrItsBorders) {
    for (const size_t count : {1U, 7U, 60U, 400U}) {
        const auto charts = some_waves(count, 20 + count);
        const Prefix prefix = powers_of_two(charts, 0);
        const auto view = PageLayerView::create(prefix.words, prefix.steps);
        ASSERT_TRUE(view.ok()) << view.error().text();
        uint64_t shown = 0;
        for (uint32_t i = 0; i < count; ++i) {
            if (view->chart(i).flat) continue;
            const auto [width, height] = size_of(*view, i);
            EXPECT_GE(width, charts[i].width);
            EXPECT_GE(height, charts[i].height);
            shown += (uint64_t{width} + 2 * view->border()) * (height + 2 * view->border());
        }
        for (uint32_t page = 0; page < view->page_count(); ++page)
            EXPECT_TRUE(std::has_single_bit(view->width(page)) && std::has_single_bit(view->height(page)));
        EXPECT_EQ(shown, page_texels(*view)) << count << " charts";
    }
}

TEST(PageLayer, ChartsAreStretchedFromWhatIsAskedForTowardsTheirOwnSize) {
    std::vector<ChartImage> charts;
    for (uint32_t i = 0; i < 90; ++i) charts.push_back(waves(60 + 7 * (i % 9), 90 + i, false, i));
    const auto total = [&](float asked, std::array<size_t, 2>& sizes) {
        const Prefix prefix = powers_of_two(charts, asked, {.mips = 0});
        const auto view = PageLayerView::create(prefix.words, prefix.steps);
        EXPECT_TRUE(view.ok());
        for (uint32_t i = 0; i < charts.size(); ++i) {
            const auto [width, height] = size_of(*view, i);
            EXPECT_GE(static_cast<float>(width) * std::max(asked, 0.1F), 0.1F * static_cast<float>(charts[i].width));
            EXPECT_GE(static_cast<float>(height) * std::max(asked, 0.1F), 0.1F * static_cast<float>(charts[i].height));
            ++sizes[width >= charts[i].width && height >= charts[i].height ? 1 : 0];
        }
        return page_texels(*view);
    };
    std::array<size_t, 2> all{}, some{};
    const uint64_t own = total(0, all), coarser = total(0.14F, some);
    EXPECT_EQ(all[0], 0U) << "smaller than they are, though nothing coarser is asked for";
    EXPECT_LT(coarser, own);
    EXPECT_GT(some[0], 0U);
    const Prefix tight = encoded(charts);
    const auto steps = encode_pages(charts, {}, std::vector<float>(charts.size(), 0.14F));
    EXPECT_EQ(prefix_of(*steps, steps->size()).words, tight.words) << "tight pages keep charts as they are";
}

TEST(PageLayer, TravelsInPlanes) {
    const auto charts = some_waves(50, 12);
    const auto steps = encode_pages(charts, {2, 4});
    ASSERT_TRUE(steps.ok());
    const auto frames = encode_steps(*steps);
    for (size_t i = 0; i < steps->size(); ++i) {
        const auto words = decode_step(frames[i], 4 * (*steps)[i].words.size());
        ASSERT_TRUE(words.ok()) << words.error().text();
        EXPECT_EQ(*words, (*steps)[i].words);
    }
}

/// Samples all over a layer that passed its checks; the shader throws where it would read outside.
void sample_everywhere(const PageLayerView& view, std::span<const uint32_t> words, Dice& dice) {
    for (uint32_t i = 0; i < std::min(view.chart_count(), 20U); ++i) {
        const std::array<float, 2> place = {static_cast<float>(dice.roll(0, 4000)) / 1000 - 2,
                                            static_cast<float>(dice.roll(0, 4000)) / 1000 - 2};
        const float change = std::exp2(static_cast<float>(dice.roll(0, 20)) - 15);
        EXPECT_NO_THROW(shaders_test::sample_paged_on_cpu(words, i, place, {change, 0}, {0, change},
                                                          static_cast<float>(view.finest_mip())));
    }
}

TEST(PageLayer, RefusesEveryTruncation) {
    const Prefix prefix = encoded(some_waves(6, 13));
    for (size_t size = 0; size < prefix.words.size(); ++size) {
        const std::span<const uint32_t> part(prefix.words.data(), size);
        EXPECT_FALSE(PageLayerView::create(part, prefix.steps).ok());
        const uint32_t step = static_cast<uint32_t>(size);
        if (size >= prefix.steps[0]) continue;
        EXPECT_FALSE(PageLayerView::create(part, {&step, 1}).ok());
    }
    EXPECT_FALSE(PageLayerView::create({}, {}).ok());
}

TEST(PageLayer, MutatedWordsAreRefusedOrSafe) {
    const Prefix prefix = encoded(some_waves(12, 14));
    Dice dice(15);
    size_t accepted = 0;
    for (int round = 0; round < 4000; ++round) {
        std::vector<uint32_t> words = prefix.words;
        const uint32_t most = dice.roll(0, 3) == 0 ? static_cast<uint32_t>(words.size()) - 1 : 60;
        for (uint32_t i = dice.roll(1, 3); i-- > 0;) {
            uint32_t& word = words[dice.roll(0, most)];
            word = dice.roll(0, 1) == 0 ? word ^ 1U << dice.roll(0, 31) : dice.roll(0, ~0U - 1);
        }
        const auto view = PageLayerView::create(words, prefix.steps);
        if (!view) continue;
        ++accepted;
        sample_everywhere(*view, words, dice);
    }
    EXPECT_GT(accepted, 200U);
}

}  // namespace
}  // namespace citystream::codec::atlas
