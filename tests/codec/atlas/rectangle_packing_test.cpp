#include "codec/atlas/rectangle_packing.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

using namespace tests;

struct Packer {
    PackMethod method;
    uint32_t taste;
};

std::vector<Packer> all_packers() {
    std::vector<Packer> packers = {{PackMethod::kBinaryTree, 0}};
    for (uint32_t taste = 0; taste < kPackTastes; ++taste) {
        packers.push_back({PackMethod::kGuillotine, taste});
        packers.push_back({PackMethod::kSkyline, taste});
    }
    return packers;
}

/// The tree cuts the bin into regions; each rectangle lies in its leaf's. Gives how many leaves hold one.
size_t leaves_with_rectangles(const Packing& packing) {
    size_t count = 0;
    for (size_t i = 0; i < packing.tree.nodes.size(); ++i) {
        const SlicingNode& node = packing.tree.nodes[i];
        if (node.cut != SlicingNode::Cut::kNone) {
            EXPECT_GT(node.first, i);
            EXPECT_GT(node.second, i);
            EXPECT_LT(std::max(node.first, node.second), packing.tree.nodes.size());
        } else if (node.rectangle != SlicingNode::kEmpty) {
            EXPECT_LT(node.rectangle, packing.places.size());
            ++count;
        }
    }
    return count;
}

void expect_sound(const Packing& packing, std::span<const RectangleSize> sizes, RectangleSize bin, Packer packer) {
    EXPECT_TRUE(layout_is_valid(packing.places, bin));
    size_t placed = 0;
    for (size_t i = 0; i < sizes.size(); ++i) {
        if (packing.places[i].area() == 0) continue;
        ++placed;
        EXPECT_EQ(packing.places[i].size(), sizes[i]);
    }
    EXPECT_EQ(placed, packing.placed);
    EXPECT_EQ(packing.tree.nodes.empty(), packer.method == PackMethod::kSkyline);
    EXPECT_EQ(leaves_with_rectangles(packing), packing.tree.nodes.empty() ? 0 : placed);
}

TEST(PredictedBin, IsTheSmallestPowerOfTwoThatHoldsTheAreaAndAtMostTwiceAsWideAsHigh) {
    std::vector<uint64_t> areas = {1, 2, 3, 4, 5, 23, 24, 25, 1000, 16777216, 16777217, uint64_t{1} << 40};
    for (uint32_t bit = 1; bit < 56; ++bit) {
        for (const uint64_t near : {(uint64_t{1} << bit) - 1, uint64_t{1} << bit, (uint64_t{1} << bit) + 1})
            areas.push_back(near);
    }
    Dice dice(1);
    for (int i = 0; i < 10000; ++i) areas.push_back(1 + (uint64_t{dice.roll(0, ~0u)} << dice.roll(0, 20)));
    for (const uint64_t area : areas) {
        const RectangleSize bin = predicted_bin(area);
        ASSERT_TRUE(std::has_single_bit(bin.width) && std::has_single_bit(bin.height)) << area;
        ASSERT_TRUE(bin.width == bin.height || bin.width == 2 * bin.height) << area;
        ASSERT_GE(bin.area(), area);
        ASSERT_LT(bin.area() / 2, area) << area;
    }
}

TEST(PredictedBin, OfAnExactPowerOfTwoIsThatPower) {
    // log2 in floating point can land on either side of a whole number (pitfall 17).
    EXPECT_EQ(predicted_bin(uint64_t{1} << 24), (RectangleSize{4096, 4096}));
    EXPECT_EQ(predicted_bin((uint64_t{1} << 24) + 1), (RectangleSize{8192, 4096}));
    EXPECT_EQ(predicted_bin(uint64_t{1} << 23), (RectangleSize{4096, 2048}));
    EXPECT_EQ(predicted_bin(0), (RectangleSize{1, 1}));
    EXPECT_EQ(next_bin({4096, 2048}), (RectangleSize{4096, 4096}));
    EXPECT_EQ(next_bin({2048, 2048}), (RectangleSize{4096, 2048}));
}

TEST(SmallestBin, OfOneLongStripIsNotSquare) {
    const std::vector<RectangleSize> strip = {{4096, 4}};
    EXPECT_EQ(smallest_bin(strip), (RectangleSize{4096, 4}));
    const std::vector<RectangleSize> upright = {{1, 300}};
    EXPECT_EQ(smallest_bin(upright), (RectangleSize{1, 512}));
    const std::vector<RectangleSize> squares(4, RectangleSize{16, 16});
    EXPECT_EQ(smallest_bin(squares), (RectangleSize{32, 32}));
}

TEST(LayoutIsValid, SeesAnOverlapOfOneCellAndOneCellOutside) {
    const RectangleSize bin = {10, 10};
    EXPECT_TRUE(layout_is_valid(std::vector<Rectangle>{{0, 0, 5, 10}, {5, 0, 5, 4}, {5, 4, 5, 6}, {}}, bin));
    EXPECT_FALSE(layout_is_valid(std::vector<Rectangle>{{0, 0, 5, 5}, {4, 4, 2, 2}}, bin));
    EXPECT_FALSE(layout_is_valid(std::vector<Rectangle>{{4, 0, 2, 5}, {0, 4, 10, 2}}, bin));
    EXPECT_FALSE(layout_is_valid(std::vector<Rectangle>{{0, 0, 5, 5}, {0, 0, 5, 5}}, bin));
    EXPECT_FALSE(layout_is_valid(std::vector<Rectangle>{{6, 0, 5, 5}}, bin));
    EXPECT_FALSE(layout_is_valid(std::vector<Rectangle>{{0, 9, 5, 2}}, bin));
}

TEST(PackRectangles, BinaryTreeFollowsAlgorithmFour) {
    // 6 x 4 first: slack 4 across and 2 up, so the cut goes across; 4 x 3 then fits the strip beside it, 5 x 2 the one
    // above.
    const std::vector<RectangleSize> sizes = {{4, 3}, {6, 4}, {5, 2}};
    const Packing packing = pack_rectangles(sizes, {10, 6}, PackMethod::kBinaryTree);
    ASSERT_TRUE(packing.complete());
    EXPECT_EQ(packing.places[1], (Rectangle{0, 0, 6, 4}));
    EXPECT_EQ(packing.places[2], (Rectangle{0, 4, 5, 2}));
    EXPECT_EQ(packing.places[0], (Rectangle{6, 0, 4, 3}));
}

TEST(PackRectangles, NeverOverlapsOrLeavesTheBinOnAThousandRandomSets) {
    const auto packers = all_packers();
    for (uint64_t seed = 0; seed < 1000; ++seed) {
        Dice dice(seed);
        const RectangleSize bin = {dice.roll(1, 96), dice.roll(1, 96)};
        const auto sizes = random_sizes(dice, dice.roll(0, 80), 1, dice.roll(1, 40));
        const Packer packer = packers[seed % packers.size()];
        const PackWhole whole = dice.roll(0, 1) != 0 ? PackWhole::kAllOrNothing : PackWhole::kAsManyAsFit;
        const Packing packing = pack_rectangles(sizes, bin, packer.method, packer.taste, whole);
        expect_sound(packing, sizes, bin, packer);
        if (HasFailure()) FAIL() << "seed " << seed;
    }
}

TEST(PackRectangles, FillsABinWithEqualTilesAndWithStripsCompletely) {
    for (const Packer packer : all_packers()) {
        const std::vector<RectangleSize> tiles(64, RectangleSize{8, 4});
        const Packing tiled = pack_rectangles(tiles, {64, 32}, packer.method, packer.taste);
        EXPECT_TRUE(tiled.complete());
        expect_sound(tiled, tiles, {64, 32}, packer);
        const std::vector<RectangleSize> strips(33, RectangleSize{1, 64});
        EXPECT_TRUE(pack_rectangles(strips, {33, 64}, packer.method, packer.taste).complete());
        EXPECT_EQ(pack_rectangles(strips, {32, 64}, packer.method, packer.taste, PackWhole::kAsManyAsFit).placed, 32u);
    }
}

TEST(PackRectangles, LeavesOutOnlyWhatIsLargerThanTheBin) {
    const std::vector<RectangleSize> sizes = {{4, 4}, {100, 1}, {1, 100}, {16, 8}, {8, 4}};
    for (const Packer packer : all_packers()) {
        const Packing packing = pack_rectangles(sizes, {16, 16}, packer.method, packer.taste, PackWhole::kAsManyAsFit);
        EXPECT_EQ(packing.placed, 3u);
        EXPECT_EQ(packing.places[1].area() + packing.places[2].area(), 0u);
        EXPECT_FALSE(pack_rectangles(sizes, {16, 16}, packer.method, packer.taste).complete());
    }
}

TEST(PackRectangles, GivesTheSameLayoutWhateverTheOrderOfEqualCalls) {
    Dice dice(7);
    const auto sizes = random_sizes(dice, 300, 1, 24);
    for (const Packer packer : all_packers()) {
        const Packing a = pack_rectangles(sizes, {256, 256}, packer.method, packer.taste);
        const Packing b = pack_rectangles(sizes, {256, 256}, packer.method, packer.taste);
        EXPECT_EQ(a.places, b.places);
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
