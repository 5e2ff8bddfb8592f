#include "codec/atlas/rectangle_packing_atlas.h"

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>

#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

using namespace tests;

/// Everything that must hold of any packing, whatever the options; texels are counted.
void expect_sound(const AtlasPacking& packing, std::span<const ChartRequest> charts,
                  const AtlasPackingOptions& options) {
    ASSERT_EQ(packing.charts.size(), charts.size());
    for (size_t i = 0; i < charts.size(); ++i) {
        const PackedChart& chart = packing.charts[i];
        ASSERT_LT(chart.page, packing.pages.size());
        ASSERT_GT(chart.padded.area(), 0u);
        for (const uint32_t side : {chart.padded.x, chart.padded.y, chart.padded.width, chart.padded.height})
            ASSERT_EQ(side % packing.unit, 0u);
        ASSERT_TRUE(chart.padded.size().fits_in({options.max_chart_side, options.max_chart_side}));
        ASSERT_TRUE(charts[i].wanted.fits_in(chart.interior.size()));
        ASSERT_EQ(chart.padded.area(), chart.interior.area() + border_cost(chart.interior.size(), chart.border));
        ASSERT_EQ(chart.border, border_of(options.border, options.mips, charts[i].repeat_u, charts[i].repeat_v));
        if (options.fill_beyond_source) continue;
        // Alignment alone may add less than a unit.
        ASSERT_LT(chart.interior.width, charts[i].source.width + packing.unit);
        ASSERT_LT(chart.interior.height, charts[i].source.height + packing.unit);
    }
    for (uint32_t p = 0; p < packing.pages.size(); ++p) {
        const AtlasPage& page = packing.pages[p];
        ASSERT_LE(std::max(page.width, page.height), options.max_page_side);
        const bool powers = std::has_single_bit(page.width) && std::has_single_bit(page.height);
        ASSERT_TRUE(powers || options.shape == PageShape::kTight);
        bool once = false;
        const uint64_t covered = counted_texels(padded_on(packing, p), page.width, page.height, packing.unit, once);
        ASSERT_TRUE(once);
        const PageOccupancy& o = page.occupancy;
        ASSERT_EQ(o.texels, uint64_t{page.width} * page.height);
        ASSERT_EQ(o.texels - o.empty, covered);
        ASSERT_EQ(o.wanted + o.grown + o.beyond_source + o.border, covered);
    }
}

AtlasPackingOptions random_options(Dice& dice) {
    AtlasPackingOptions options;
    options.mips = dice.roll(0, 2);
    options.blocks = dice.roll(0, 1) != 0;
    options.packed_coordinates = dice.roll(0, 1) != 0;
    options.border = static_cast<BorderRule>(dice.roll(0, 2));
    options.max_page_side = 256 << dice.roll(0, 1);
    options.max_chart_side = 128 << dice.roll(0, 1);
    options.shape = static_cast<PageShape>(dice.roll(0, 1));
    options.effort = static_cast<PackEffort>(dice.roll(0, 2));
    options.stretch = dice.roll(0, 1) != 0;
    options.fill = static_cast<FillMode>(dice.roll(0, 3));
    options.fill_beyond_source = options.fill != FillMode::kNone && dice.roll(0, 1) != 0;
    return options;
}

TEST(PackAtlas, HoldsForAThousandRandomSetsAndOptions) {
    for (uint64_t seed = 0; seed < 1000; ++seed) {
        Dice dice(seed);
        const auto charts = random_charts(dice, dice.roll(0, 40), dice.roll(4, 40), 100);
        const AtlasPackingOptions options = random_options(dice);
        const auto packing = pack_atlas(charts, options);
        ASSERT_TRUE(packing.ok()) << packing.error().text();
        expect_sound(*packing, charts, options);
        if (HasFatalFailure()) FAIL() << "seed " << seed;
    }
}

TEST(PackAtlas, BearsExtremes) {
    const auto request = [](uint32_t w, uint32_t h) { return ChartRequest{{w, h}, {w, h}, true, false}; };
    AtlasPackingOptions options;
    options.max_chart_side = 4096;
    const std::vector<std::vector<ChartRequest>> sets = {
        {},
        {request(1, 1)},
        {request(4092, 1)},
        {request(1, 4092), request(4092, 1)},
        {request(4092, 4092)},
        {request(4092, 4092), request(4092, 4092), request(1, 1)},
        std::vector<ChartRequest>(300, request(60, 60)),
        {request(2044, 2044), request(2044, 2044), request(2044, 2044), request(2044, 2044), request(12, 12)},
    };
    for (const auto& charts : sets) {
        for (const bool fills : {false, true}) {
            options.stretch = options.fill_beyond_source = fills;
            options.fill = fills ? FillMode::kSubtrees : FillMode::kNone;
            const auto packing = pack_atlas(charts, options);
            ASSERT_TRUE(packing.ok()) << packing.error().text();
            expect_sound(*packing, charts, options);
        }
    }
    EXPECT_EQ(pack_atlas(sets[0], options)->pages.size(), 0u);
    EXPECT_EQ(pack_atlas(sets[5], options)->pages.size(), 3u);
    EXPECT_EQ(pack_atlas(sets[7], options)->pages.size(), 2u);
}

TEST(PackAtlas, RefusesWhatItCannotPackInsteadOfCuttingItOff) {
    const auto refused = [](ChartRequest chart, AtlasPackingOptions options) {
        const auto packing = pack_atlas(std::vector<ChartRequest>{chart}, options);
        return !packing.ok() && !packing.error().message.empty();
    };
    const AtlasPackingOptions usual;
    EXPECT_TRUE(refused({{0, 5}, {5, 5}}, usual));
    EXPECT_TRUE(refused({{5, 0}, {5, 5}}, usual));
    EXPECT_TRUE(refused({{6, 5}, {5, 5}}, usual));
    EXPECT_TRUE(refused({{509, 4}, {600, 600}}, usual));
    EXPECT_FALSE(refused({{508, 4}, {600, 600}}, usual));
    EXPECT_TRUE(refused({{~0u, 4}, {~0u, ~0u}}, usual));
    AtlasPackingOptions bad = usual;
    bad.mips = kMostMips + 1;
    EXPECT_TRUE(refused({{4, 4}, {4, 4}}, bad));
    bad = usual;
    bad.max_page_side = 8;
    EXPECT_TRUE(refused({{4, 4}, {4, 4}}, bad));
    bad = usual;
    bad.max_chart_side = 8192;
    EXPECT_TRUE(refused({{4, 4}, {4, 4}}, bad));
    bad = usual;
    bad.max_page_side = bad.max_chart_side = ~0u;
    EXPECT_TRUE(refused({{4, 4}, {4, 4}}, bad));
}

/// Charts for a page of side `side`, of which they take about `part` with borders.
std::vector<ChartRequest> table_set(size_t count, uint32_t side, double part) {
    Dice dice(count);
    std::vector<ChartRequest> charts = random_charts(dice, count, 256, 2000);
    uint64_t area = 0;
    for (const ChartRequest& chart : charts) area += chart.wanted.area();
    const double scale = std::sqrt(part * side * side / static_cast<double>(area));
    for (ChartRequest& chart : charts) {
        const auto scaled = [scale](uint32_t texels) {
            return std::clamp<uint32_t>(static_cast<uint32_t>(texels * scale), 4, 400);
        };
        chart.wanted = {scaled(chart.wanted.width), scaled(chart.wanted.height)};
        chart.source = {chart.wanted.width * 3 / 2, chart.wanted.height * 3 / 2};
    }
    return charts;
}

TEST(PackAtlas, OrdersTheFourModesAsTableFourteenDoesAndEndsAtExactlyAllTexels) {
    const struct {
        size_t count;
        uint32_t side;
        double part;
        uint32_t mips;
    } sets[] = {{192, 2048, 0.68, 0}, {192, 2048, 0.62, 2}, {378, 2048, 0.62, 2},
                {1107, 4096, 0.6, 2}, {1689, 4096, 0.6, 2}, {2897, 4096, 0.58, 2}};
    for (const auto& set : sets) {
        const auto charts = table_set(set.count, set.side, set.part);
        const auto packed = [&](PackEffort effort, bool stretch, FillMode fill, bool beyond) {
            AtlasPackingOptions options;
            options.mips = set.mips;
            options.effort = effort;
            options.stretch = stretch;
            options.fill = fill;
            options.fill_beyond_source = beyond;
            const auto packing = pack_atlas(charts, options);
            EXPECT_TRUE(packing.ok());
            expect_sound(*packing, charts, options);
            EXPECT_EQ(packing->pages.size(), 1u);
            EXPECT_EQ(packing->pages[0].width, set.side);
            EXPECT_EQ(packing->pages[0].height, set.side);
            return total_occupancy(*packing);
        };
        const auto plain = packed(PackEffort::kBinaryTree, false, FillMode::kNone, false);
        const auto fill = packed(PackEffort::kBinaryTree, false, FillMode::kSiblingLeaves, true);
        const auto optimised = packed(PackEffort::kBinaryTree, true, FillMode::kNone, false);
        const auto both = packed(PackEffort::kBinaryTree, true, FillMode::kSubtrees, true);
        EXPECT_LT(plain.covered(), fill.covered());
        EXPECT_LT(plain.covered(), optimised.covered());
        EXPECT_LT(optimised.covered(), both.covered());
        EXPECT_EQ(both.empty, 0u);
        const auto ours = packed(PackEffort::kStrongest, true, FillMode::kInPlace, false);
        const auto filled = packed(PackEffort::kStrongestTree, true, FillMode::kSubtrees, true);
        EXPECT_GE(ours.usable(), 0.98) << set.count;
        EXPECT_EQ(filled.empty, 0u);
        EXPECT_GT(ours.usable(), optimised.usable());
    }
}

TEST(PackAtlas, SpreadsChartsThatExceedOnePage) {
    Dice dice(5);
    const auto charts = random_charts(dice, 500, 100, 480);
    AtlasPackingOptions options;
    options.max_page_side = 1024;
    const auto packing = pack_atlas(charts, options);
    ASSERT_TRUE(packing.ok());
    expect_sound(*packing, charts, options);
    uint64_t wanted = 0;
    for (const PackedChart& chart : packing->charts) wanted += chart.padded.area();
    const uint64_t least_pages = (wanted + 1024 * 1024 - 1) / (1024 * 1024);
    EXPECT_GT(least_pages, 3u);
    EXPECT_LE(packing->pages.size(), least_pages + 1);
}

TEST(PackAtlas, TightPagesAreNearlyFullWithoutGrowingAnything) {
    const auto charts = table_set(378, 2048, 0.55);
    AtlasPackingOptions options;
    options.mips = 0;
    options.border = BorderRule::kWhereRepeating;
    const auto power_of_two = pack_atlas(charts, options);
    options.shape = PageShape::kTight;
    const auto tight = pack_atlas(charts, options);
    ASSERT_TRUE(power_of_two.ok() && tight.ok());
    expect_sound(*tight, charts, options);
    EXPECT_GE(total_occupancy(*tight).covered(), 0.97);
    EXPECT_LT(total_occupancy(*tight).texels * 3, total_occupancy(*power_of_two).texels * 2);
    EXPECT_EQ(tight->pages[0].stretch, 0u);
}

TEST(PackAtlas, StatesWhatGrowsBeyondItsSourceAndAvoidsItOnRequest) {
    auto charts = table_set(192, 2048, 0.6);
    for (ChartRequest& chart : charts) chart.source = chart.wanted;
    AtlasPackingOptions options;
    options.mips = 0;
    options.stretch = true;
    options.fill = FillMode::kSubtrees;
    options.fill_beyond_source = true;
    const PageOccupancy filled = total_occupancy(*pack_atlas(charts, options));
    EXPECT_EQ(filled.empty, 0U);
    options.fill_beyond_source = false;
    const auto modest = pack_atlas(charts, options);
    expect_sound(*modest, charts, options);
    const PageOccupancy kept = total_occupancy(*modest);
    EXPECT_LT(kept.beyond_source, kept.texels / 50);
    EXPECT_GT(kept.empty, kept.texels / 5);
    EXPECT_GT(filled.beyond_source, 5 * kept.beyond_source);
}

TEST(PackAtlas, PagesThatNoChartMayFillFurtherAreHalvedUntilTheyAreFull) {
    // Charts of nearly the greatest size, of which a page holds four: five would leave three quarters of one empty.
    std::vector<ChartRequest> charts(5, {{480, 480}, {504, 504}, true, true});
    charts.push_back({{100, 30}, {100, 30}});
    AtlasPackingOptions options;
    options.stretch = true;
    options.fill = FillMode::kSubtrees;
    options.fill_beyond_source = true;
    const auto packing = pack_atlas(charts, options);
    ASSERT_TRUE(packing.ok());
    expect_sound(*packing, charts, options);
    EXPECT_EQ(total_occupancy(*packing).empty, 0U);
    EXPECT_GT(packing->pages.size(), 1U);
    options.fill = FillMode::kNone;
    const auto predicted = pack_atlas(charts, options);
    EXPECT_EQ(predicted->pages.size(), 1U);
    EXPECT_LT(total_occupancy(*predicted).covered(), 0.8);
}

TEST(PackAtlas, PacksTwentyFourThousandChartsInSeconds) {
    Dice dice(6);
    const auto charts = random_charts(dice, 24000, 70, 480);
    AtlasPackingOptions options;
    options.mips = 0;
    const auto start = std::chrono::steady_clock::now();
    const auto packing = pack_atlas(charts, options);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(packing.ok());
    EXPECT_GT(packing->pages.size(), 2u);
    for (size_t p = 0; p + 1 < packing->pages.size(); ++p) EXPECT_GE(packing->pages[p].occupancy.covered(), 0.98);
    EXPECT_LT(seconds.count(), 15);
}

TEST(PackAtlas, GivesTheSamePackingTwice) {
    Dice dice(8);
    const auto charts = random_charts(dice, 300, 60, 300);
    AtlasPackingOptions options;
    options.stretch = true;
    options.fill = FillMode::kSubtrees;
    const auto a = pack_atlas(charts, options), b = pack_atlas(charts, options);
    for (size_t i = 0; i < charts.size(); ++i) EXPECT_EQ(a->charts[i].padded, b->charts[i].padded);
}

}  // namespace
}  // namespace citystream::codec::atlas
