#include "codec/atlas/rectangle_packing_fill.h"

#include <gtest/gtest.h>

#include "codec/atlas/rectangle_packing_stretch.h"
#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

using namespace tests;

constexpr RectangleSize kNoLimit = {kMaxBinSide, kMaxBinSide};

std::vector<GrowthLimit> limits_of(std::span<const RectangleSize> sizes, RectangleSize wanted_most,
                                   RectangleSize most) {
    std::vector<GrowthLimit> limits;
    for (const RectangleSize size : sizes) limits.push_back({size, wanted_most, most});
    return limits;
}

uint64_t area_of(std::span<const Rectangle> places) {
    uint64_t area = 0;
    for (const Rectangle& place : places) area += place.area();
    return area;
}

TEST(FillLeaves, CoversTheBinCompletelyAndShrinksNothingOnRandomSets) {
    size_t filled = 0;
    for (uint64_t seed = 0; seed < 600; ++seed) {
        Dice dice(seed);
        const RectangleSize bin = {dice.roll(20, 128), dice.roll(20, 128)};
        const auto sizes = random_sizes(dice, dice.roll(1, 60), 1, dice.roll(2, 20));
        const PackMethod method = seed % 2 == 0 ? PackMethod::kBinaryTree : PackMethod::kGuillotine;
        const Packing packing = pack_rectangles(sizes, bin, method, method == PackMethod::kGuillotine ? seed % 4 : 0);
        if (!packing.complete()) continue;
        ++filled;
        const auto places = fill_leaves(packing, bin, limits_of(sizes, kNoLimit, kNoLimit), FillMode::kSubtrees);
        ASSERT_TRUE(layout_is_valid(places, bin)) << seed;
        ASSERT_EQ(area_of(places), bin.area()) << seed;
        for (size_t i = 0; i < sizes.size(); ++i) ASSERT_TRUE(sizes[i].fits_in(places[i].size())) << seed;
    }
    EXPECT_GT(filled, 300u);
}

TEST(FillLeaves, AsPrintedLeavesAnEmptyLeafBesideASubtreeEmpty) {
    // 4 x 4 and 2 x 2 in 8 x 8: the upper half is empty and its sibling is no leaf.
    const std::vector<RectangleSize> sizes = {{4, 4}, {2, 2}};
    const RectangleSize bin = {8, 8};
    const Packing packing = pack_rectangles(sizes, bin, PackMethod::kBinaryTree);
    ASSERT_TRUE(packing.complete());
    const auto limits = limits_of(sizes, kNoLimit, kNoLimit);
    const uint64_t as_packed = area_of(packing.places);
    const uint64_t as_printed = area_of(fill_leaves(packing, bin, limits, FillMode::kSiblingLeaves));
    EXPECT_GT(as_printed, as_packed);
    EXPECT_LT(as_printed, bin.area());
    EXPECT_EQ(area_of(fill_leaves(packing, bin, limits, FillMode::kSubtrees)), bin.area());
    EXPECT_EQ(fill_leaves(packing, bin, limits, FillMode::kNone), packing.places);
}

TEST(FillLeaves, AsPrintedNeverOverlapsOnRandomSets) {
    for (uint64_t seed = 0; seed < 300; ++seed) {
        Dice dice(seed);
        const auto sizes = random_sizes(dice, 20, 1, 20);
        const PackMethod method = seed % 2 == 0 ? PackMethod::kBinaryTree : PackMethod::kGuillotine;
        const Packing packing = pack_rectangles(sizes, {64, 64}, method);
        if (!packing.complete()) continue;
        const auto places =
            fill_leaves(packing, {64, 64}, limits_of(sizes, kNoLimit, kNoLimit), FillMode::kSiblingLeaves);
        ASSERT_TRUE(layout_is_valid(places, {64, 64})) << seed;
        for (size_t i = 0; i < sizes.size(); ++i) ASSERT_TRUE(sizes[i].fits_in(places[i].size())) << seed;
    }
}

TEST(FillLeaves, GivesSpaceFirstToWhatHasUseForIt) {
    // Two 4 x 8 charts side by side in 16 x 8; only the second one's source is wider.
    const std::vector<RectangleSize> sizes = {{4, 8}, {4, 8}};
    const Packing packing = pack_rectangles(sizes, {16, 8}, PackMethod::kBinaryTree);
    const std::vector<GrowthLimit> limits = {{{4, 8}, {4, 8}, kNoLimit}, {{4, 8}, {12, 8}, kNoLimit}};
    const auto places = fill_leaves(packing, {16, 8}, limits, FillMode::kSubtrees);
    EXPECT_EQ(places[0].width, 4u);
    EXPECT_EQ(places[1].width, 12u);
}

TEST(FillLeaves, NeverExceedsTheMostAndLeavesTheRestEmpty) {
    Dice dice(3);
    const auto sizes = random_sizes(dice, 40, 1, 12);
    const Packing packing = pack_rectangles(sizes, {128, 128}, PackMethod::kGuillotine);
    ASSERT_TRUE(packing.complete());
    std::vector<GrowthLimit> limits;
    for (const RectangleSize size : sizes)
        limits.push_back({size, {size.width + 1, size.height + 1}, {size.width + 2, size.height + 2}});
    const auto places = fill_leaves(packing, {128, 128}, limits, FillMode::kSubtrees);
    ASSERT_TRUE(layout_is_valid(places, {128, 128}));
    for (size_t i = 0; i < sizes.size(); ++i) {
        EXPECT_TRUE(sizes[i].fits_in(places[i].size()));
        EXPECT_TRUE(places[i].size().fits_in(limits[i].most));
    }
    EXPECT_LT(area_of(places), uint64_t{128} * 128);
}

TEST(FillLeaves, LeavesASkylineAsItIs) {
    const std::vector<RectangleSize> sizes = {{3, 3}, {5, 2}};
    const Packing packing = pack_rectangles(sizes, {8, 8}, PackMethod::kSkyline);
    EXPECT_EQ(fill_leaves(packing, {8, 8}, limits_of(sizes, kNoLimit, kNoLimit), FillMode::kSubtrees), packing.places);
}

/// Whether a rectangle could still grow by one unit to some side.
bool can_grow(const std::vector<Rectangle>& places, size_t i, RectangleSize bin) {
    for (int side = 0; side < 4; ++side) {
        std::vector<Rectangle> larger = places;
        Rectangle& place = larger[i];
        if ((side == 0 && place.x == 0) || (side == 1 && place.y == 0)) continue;
        if (side == 0) --place.x;
        if (side == 1) --place.y;
        ++(side % 2 == 0 ? place.width : place.height);
        if (layout_is_valid(larger, bin)) return true;
    }
    return false;
}

TEST(FillLeaves, InPlaceLeavesNothingThatCouldStillGrow) {
    for (uint64_t seed = 0; seed < 60; ++seed) {
        Dice dice(seed);
        const auto sizes = random_sizes(dice, 25, 1, 12);
        const RectangleSize bin = {dice.roll(30, 60), dice.roll(30, 60)};
        const auto method = static_cast<PackMethod>(seed % 3);
        const Packing packing = pack_rectangles(sizes, bin, method);
        if (!packing.complete()) continue;
        const auto places = fill_leaves(packing, bin, limits_of(sizes, {0, 0}, kNoLimit), FillMode::kInPlace);
        ASSERT_TRUE(layout_is_valid(places, bin)) << seed;
        for (size_t i = 0; i < sizes.size(); ++i) {
            ASSERT_TRUE(sizes[i].fits_in(places[i].size()));
            ASSERT_FALSE(can_grow(places, i, bin)) << seed << " " << i;
        }
        const RectangleSize most = {13, 14};
        for (const Rectangle& place : fill_leaves(packing, bin, limits_of(sizes, {0, 0}, most), FillMode::kInPlace))
            ASSERT_TRUE(place.size().fits_in(most));
    }
}

TEST(FillLeaves, BearsAChainOfTwentyThousandCuts) {
    const std::vector<RectangleSize> strips(20000, RectangleSize{1, 3});
    const RectangleSize bin = {30000, 4};
    const Packing packing = pack_rectangles(strips, bin, PackMethod::kGuillotine);
    ASSERT_TRUE(packing.complete());
    const auto places = fill_leaves(packing, bin, limits_of(strips, kNoLimit, kNoLimit), FillMode::kSubtrees);
    EXPECT_EQ(area_of(places), bin.area());
    EXPECT_TRUE(layout_is_valid(places, bin));
}

std::vector<StretchRange> ranges_of(std::span<const RectangleSize> least, uint32_t factor) {
    std::vector<StretchRange> ranges;
    for (const RectangleSize size : least) ranges.push_back({size, {size.width * factor, size.height * factor}});
    return ranges;
}

TEST(OptimiseStretch, KeepsEverySizeInItsRangeAndTheLastLayoutThatFits) {
    for (uint64_t seed = 0; seed < 5; ++seed) {
        Dice dice(seed);
        const auto least = random_sizes(dice, 60, 2, 20);
        const auto ranges = ranges_of(least, 3);
        const RectangleSize bin = next_bin(smallest_bin(least));
        for (const PackEffort effort : {PackEffort::kBinaryTree, PackEffort::kStrongestTree, PackEffort::kStrongest}) {
            const auto result = optimise_stretch(ranges, bin, effort);
            ASSERT_TRUE(result.has_value());
            EXPECT_TRUE(result->packing.complete());
            EXPECT_TRUE(layout_is_valid(result->packing.places, bin));
            EXPECT_GT(total_area(result->sizes), total_area(least));
            for (size_t i = 0; i < least.size(); ++i) {
                EXPECT_EQ(result->packing.places[i].size(), result->sizes[i]);
                EXPECT_TRUE(stretched(ranges[i], result->stretch).fits_in(result->sizes[i]));
                EXPECT_TRUE(result->sizes[i].fits_in(ranges[i].most));
            }
        }
    }
}

TEST(OptimiseStretch, ReachesTheMostWhereThereIsRoomAndSaysWhereThereIsNone) {
    const std::vector<RectangleSize> least(10, RectangleSize{4, 4});
    const auto all = optimise_stretch(ranges_of(least, 2), {64, 64}, PackEffort::kBinaryTree);
    ASSERT_TRUE(all.has_value());
    EXPECT_EQ(all->stretch, kStretchSteps);
    EXPECT_EQ(all->sizes, std::vector<RectangleSize>(10, RectangleSize{8, 8}));
    EXPECT_FALSE(optimise_stretch(ranges_of(least, 2), {12, 12}, PackEffort::kStrongest).has_value());
    const auto tight = optimise_stretch(ranges_of(least, 1), {8, 20}, PackEffort::kStrongest);
    ASSERT_TRUE(tight.has_value());
    EXPECT_EQ(tight->sizes, least);
}

TEST(OptimiseStretch, WithMorePackersNeverEndsLower) {
    Dice dice(11);
    const auto least = random_sizes(dice, 192, 4, 40);
    const auto ranges = ranges_of(least, 4);
    const RectangleSize bin = smallest_bin(least);
    const auto paper = optimise_stretch(ranges, bin, PackEffort::kBinaryTree);
    const auto ours = optimise_stretch(ranges, bin, PackEffort::kStrongest);
    ASSERT_TRUE(paper.has_value() && ours.has_value());
    EXPECT_GE(total_area(ours->sizes), total_area(paper->sizes));
}

}  // namespace
}  // namespace citystream::codec::atlas
