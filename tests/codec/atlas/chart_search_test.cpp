#include "codec/atlas/chart_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

constexpr SearchOrder kOrders[] = {SearchOrder::kWidthFirst, SearchOrder::kHeightFirst, SearchOrder::kBoth,
                                   SearchOrder::kAlternate, SearchOrder::kBest};

SearchSettings settings_of(MetricKind kind, double tolerance, SearchOrder order = SearchOrder::kBoth) {
    SearchSettings settings;
    settings.metric = {kind, tolerance};
    settings.order = order;
    return settings;
}

/// The same with alpha of every value: rising from one side to the other, or noise.
Image with_alpha(const Image& image, uint32_t seed) {
    const std::vector<uint8_t> rgb = srgb_bytes(image);
    sample::Noise noise(seed);
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i < image.area(); ++i) {
        bytes.insert(bytes.end(), &rgb[3 * i], &rgb[3 * i] + 3);
        bytes.push_back(static_cast<uint8_t>(seed % 2 ? noise() : i % image.width * 255 / image.width));
    }
    return linear_image(image.width, image.height, 4, bytes);
}

/// Pictures of many kinds and shapes, one for each number.
Image picture_of(uint32_t i) {
    const uint32_t width = 20 + i * 7 % 45, height = 17 + i * 11 % 40;
    switch (i % 6) {
        case 5:
            return with_alpha(sample::blotches(width, height, i), i / 6);
        case 0:
            return sample::facade(width, height, 6 + i % 11);
        case 1:
            return sample::blotches(width, height, i, 20 + static_cast<int>(i));
        case 2:
            return sample::with_noise(sample::facade(width, height, 12), 3 + i % 60, i);
        case 3:
            return sample::picture(width, height, [&](uint32_t x, uint32_t y, uint32_t c) {
                return 40 + 3 * x + (c + 1) * y + (i % 2 ? 90 * (x / 9 % 2) : 0);
            });
        default:
            return sample::with_noise(sample::flat(width, height, 90, 120, 200), i, i);
    }
}

/// What the stored bytes look like beside the original, computed anew.
double error_again(const Image& original, const SearchResult& result, const SearchSettings& settings) {
    const Image stored = linear_image(chart_image(result.image));
    EXPECT_EQ(stored, result.image);
    Image shown = resample(stored, original.width, original.height, settings.filter, settings.edges), seen = original;
    if (settings.there) test_alpha(shown), test_alpha(seen);
    return MetricReference(seen, settings.metric.kind, settings.view).error(shown);
}

double log2_of(uint32_t side) {
    return std::log2(static_cast<double>(side));
}

TEST(ChartSearch, TheStoredChartNeverExceedsTheToleranceAgainstTheOriginal) {
    for (uint32_t i = 0; i < 100; ++i) {
        const Image original = picture_of(i);
        for (const double tolerance : {0.05, 0.1, 0.2, 0.3, 0.5}) {
            for (const MetricKind kind : {MetricKind::kRmse, MetricKind::kHvse}) {
                const SearchSettings settings = settings_of(kind, tolerance, kOrders[i % 5]);
                const SearchResult result = search_chart(original, settings);
                ASSERT_LE(result.error, tolerance);
                ASSERT_NEAR(error_again(original, result, settings), result.error, 1e-9) << i << ' ' << tolerance;
            }
        }
    }
}

TEST(ChartSearch, EveryMetricKeepsItsToleranceAndShrinksSomething) {
    const Metric metrics[] = {{MetricKind::kNormalisedRmse, 0.3},
                              {MetricKind::kTemplateMatch, 0.2},
                              {MetricKind::kMannosSakrison, 0.3},
                              {MetricKind::kDaly, 0.3},
                              {MetricKind::kAhumada, 0.3},
                              {MetricKind::kSsim, 0.9},
                              {MetricKind::kFlip, 0.1}};
    for (const Metric& metric : metrics) {
        double before = 0, after = 0;
        for (uint32_t i = 0; i < 10; ++i) {
            const Image original = picture_of(i);
            SearchSettings settings = settings_of(metric.kind, metric.tolerance, kOrders[i % 5]);
            settings.edges = {i % 2 == 0, i % 3 == 0};
            settings.filter = i % 2 ? Shrink::kArea : Shrink::kLanczos;
            const SearchResult result = search_chart(original, settings);
            ASSERT_LE(result.error, metric.largest_error());
            ASSERT_NEAR(error_again(original, result, settings), result.error, 1e-9) << to_string(metric);
            before += static_cast<double>(original.area());
            after += static_cast<double>(result.image.area());
        }
        EXPECT_LT(after, 0.9 * before) << to_string(metric);
    }
}

TEST(ChartSearch, OneOrderAndBothTogetherEndWithinLogarithmsOfTheSides) {
    for (uint32_t i = 0; i < 60; ++i) {
        const Image original = picture_of(i);
        for (const SearchOrder order :
             {SearchOrder::kWidthFirst, SearchOrder::kHeightFirst, SearchOrder::kAlternate, SearchOrder::kBoth}) {
            for (const double tolerance : {0.0, 0.03, 0.1, 1.0}) {
                const uint32_t calls = search_chart(original, settings_of(MetricKind::kRmse, tolerance, order)).calls;
                ASSERT_LE(calls, log2_of(original.width) + log2_of(original.height) + 2);
            }
        }
        const double one = log2_of(original.width) + log2_of(original.height) + 2;
        ASSERT_LE(search_chart(original, settings_of(MetricKind::kRmse, 0.05, SearchOrder::kBest)).calls, 4 * one);
    }
}

TEST(ChartSearch, AConstantImageBecomesAsSmallAsAllowed) {
    const Image original = sample::flat(48, 37, 10, 200, 90);
    for (const SearchOrder order : kOrders) {
        for (const MetricKind kind : {MetricKind::kRmse, MetricKind::kNormalisedRmse, MetricKind::kTemplateMatch,
                                      MetricKind::kDaly, MetricKind::kHvse, MetricKind::kSsim, MetricKind::kFlip}) {
            SearchSettings settings = settings_of(kind, kind == MetricKind::kSsim ? 0.999 : 0.001, order);
            const SearchResult one = search_chart(original, settings);
            EXPECT_EQ(one.image.area(), 1) << name_of(kind);
            EXPECT_EQ(chart_image(one.image).rgb, (std::vector<uint8_t>{10, 200, 90}));
            settings.multiple = 4;
            const SearchResult four = search_chart(original, settings);
            EXPECT_EQ(four.image.width, 4);
            EXPECT_EQ(four.image.height, 4);
        }
    }
}

TEST(ChartSearch, SizesAreMultiplesWhereAskedOrTheOriginals) {
    for (uint32_t i = 0; i < 30; ++i) {
        const Image original = picture_of(i);
        SearchSettings settings = settings_of(MetricKind::kRmse, 0.03, kOrders[i % 5]);
        settings.multiple = 4;
        const Image image = search_chart(original, settings).image;
        EXPECT_TRUE(image.width % 4 == 0 || image.width == original.width);
        EXPECT_TRUE(image.height % 4 == 0 || image.height == original.height);
    }
}

TEST(ChartSearch, WhatNothingSmallerMatchesStaysAsItIs) {
    const Image noise = sample::with_noise(sample::flat(40, 30, 128, 128, 128), 120, 1);
    for (const SearchOrder order : kOrders) {
        const SearchResult result = search_chart(noise, settings_of(MetricKind::kRmse, 0, order));
        EXPECT_EQ(result.image, noise);
        EXPECT_EQ(result.error, 0);
        EXPECT_GT(result.calls, 0);
    }
    const SearchResult untouched = search_chart(noise, {});
    EXPECT_EQ(untouched.image, noise);
    EXPECT_EQ(untouched.calls, 0);
}

TEST(ChartSearch, BothOrdersTogetherAreAsSmallAsTheBetterOneAndBestNoWorseThanAny) {
    double together = 0, better = 0;
    for (uint32_t i = 0; i < 40; ++i) {
        const Image original = picture_of(i);
        const auto area = [&](SearchOrder order) {
            return search_chart(original, settings_of(MetricKind::kHvse, 0.2, order)).image.area();
        };
        const size_t width = area(SearchOrder::kWidthFirst), height = area(SearchOrder::kHeightFirst),
                     both = area(SearchOrder::kBoth), best = area(SearchOrder::kBest);
        EXPECT_LE(best, std::max({width, height, both, area(SearchOrder::kAlternate)}));
        EXPECT_LE(best, std::min(width, height));
        together += static_cast<double>(both);
        better += static_cast<double>(std::min(width, height));
    }
    EXPECT_LT(together, 1.01 * better);
}

TEST(ChartSearch, ChartsWithAlphaAreJudgedAsTheyAreDrawn) {
    int smaller = 0;
    for (uint32_t i = 0; i < 12; ++i) {
        const Image original = with_alpha(sample::blotches(40 + i, 36, i, 15), i);
        SearchSettings settings = settings_of(MetricKind::kRmse, 0.15);
        settings.there = there_of(chart_image(original));
        const SearchResult result = search_chart(original, settings);
        ASSERT_LE(error_again(original, result, settings), 0.15);
        EXPECT_NEAR(there_of(chart_image(result.image)).value(), settings.there->value(), 0.05) << i;
        smaller += result.image.area() < original.area() ? 1 : 0;
    }
    EXPECT_GE(smaller, 6);
}

TEST(ChartSearch, MoreToleranceGivesSmallerCharts) {
    for (const MetricKind kind : {MetricKind::kRmse, MetricKind::kHvse}) {
        double previous_mean = 1e9;
        std::vector<size_t> previous(40, ~size_t{0});
        for (const double tolerance : {0.02, 0.05, 0.1, 0.2, 0.4}) {
            double sum = 0;
            for (uint32_t i = 0; i < 40; ++i) {
                const size_t area =
                    search_chart(picture_of(i), settings_of(kind, tolerance, SearchOrder::kBest)).image.area();
                EXPECT_LE(area, previous[i]) << name_of(kind) << ' ' << i << " at " << tolerance;
                previous[i] = area;
                sum += static_cast<double>(area);
            }
            EXPECT_LT(sum / 40, previous_mean);
            previous_mean = sum / 40;
        }
    }
}

TEST(ChartSearch, RmseCollapsesFacadesWithoutNoiseFarMoreThanHvse) {
    for (const uint32_t bay : {8u, 16u, 24u}) {
        const Image wall = sample::facade(96, 96, bay);
        const size_t by_rmse = search_chart(wall, settings_of(MetricKind::kRmse, 0.2)).image.area();
        const size_t by_hvse = search_chart(wall, settings_of(MetricKind::kHvse, 0.2)).image.area();
        EXPECT_EQ(by_rmse, 1);
        EXPECT_GT(by_hvse, 20 * by_rmse);
    }
}

TEST(ChartSearch, AMetricThatIsNotMonotoneIsNeverExceeded) {
    // Pitfall 14: stripes whose phase decides what bilinear sampling finds.
    for (const uint32_t period : {2u, 3u, 5u, 7u}) {
        const Image stripes =
            sample::picture(60, 60, [&](uint32_t x, uint32_t, uint32_t) { return x % period == 0 ? 250 : 20; });
        for (const SearchOrder order : kOrders) {
            SearchSettings settings = settings_of(MetricKind::kRmse, 0.25, order);
            settings.filter = Shrink::kBilinear;
            const SearchResult result = search_chart(stripes, settings);
            EXPECT_LE(error_again(stripes, result, settings), 0.25);
        }
    }
}

TEST(ChartSearch, ExtremeShapesAreSearched) {
    for (const auto& [width, height] :
         std::vector<std::pair<uint32_t, uint32_t>>{{1, 1}, {1, 300}, {4096, 4}, {2, 1}}) {
        const Image original = sample::blotches(width, height, width);
        for (const SearchOrder order : kOrders) {
            const SearchResult result = search_chart(original, settings_of(MetricKind::kHvse, 0.3, order));
            EXPECT_LE(result.error, 0.3);
            EXPECT_LE(result.image.area(), original.area());
        }
    }
}

TEST(ChartSearch, GreyAndAlphaAreSearchedToo) {
    std::vector<uint8_t> leaf;
    for (uint32_t i = 0; i < 40 * 40; ++i) {
        const bool inside = (i % 40 - 20) * (i % 40 - 20) + (i / 40 - 20) * (i / 40 - 20) < 200;
        leaf.insert(leaf.end(), {30, 120, 20, static_cast<uint8_t>(inside ? 255 : 0)});
    }
    const Image with_alpha = linear_image(40, 40, 4, leaf);
    for (const MetricKind kind : {MetricKind::kRmse, MetricKind::kHvse, MetricKind::kSsim, MetricKind::kFlip}) {
        const double tolerance = kind == MetricKind::kSsim ? 0.8 : 0.15;
        const SearchResult result = search_chart(with_alpha, settings_of(kind, tolerance));
        EXPECT_EQ(result.image.channels, 4);
        EXPECT_GT(result.image.area(), 16) << name_of(kind) << ": the outline of the alpha must be kept";
        EXPECT_LT(result.image.area(), 1600);
        Image grey(40, 40, 1);
        std::copy_n(with_alpha.plane(3).data(), grey.area(), grey.texels.begin());
        EXPECT_LT(search_chart(grey, settings_of(kind, tolerance)).image.area(), 1600);
    }
}

TEST(ChartSearch, NamesOfOrdersAreParsed) {
    for (const SearchOrder order : kOrders) EXPECT_EQ(parse_search_order(name_of(order)), order);
    EXPECT_FALSE(parse_search_order("random"));
}

}  // namespace
}  // namespace citystream::codec::atlas
