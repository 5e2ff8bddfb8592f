#include "codec/atlas/chart_border.h"

#include <gtest/gtest.h>

#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

std::vector<uint8_t> random_texels(tests::Dice& dice, RectangleSize size, uint32_t channels) {
    std::vector<uint8_t> texels(size.area() * channels);
    for (uint8_t& value : texels) value = static_cast<uint8_t>(dice.roll(0, 255));
    return texels;
}

TEST(ChartBorder, OfEquationThreeIsZeroOneTwo) {
    EXPECT_EQ(border_for_mips(0), 0u);
    EXPECT_EQ(border_for_mips(1), 1u);
    EXPECT_EQ(border_for_mips(2), 2u);
    EXPECT_EQ(border_for_mips(5), 16u);
}

TEST(ChartBorder, IsHalfATexelOfTheCoarsestMip) {
    for (uint32_t mips = 1; mips <= kMostMips; ++mips) EXPECT_EQ(2 * border_for_mips(mips), 1u << mips);
}

TEST(ChartBorder, CostsTexelsOnlyWhereTheRuleAsksForThem) {
    EXPECT_EQ(border_of(BorderRule::kPaper, 2, false, true), (ChartBorder{2, 2}));
    EXPECT_EQ(border_of(BorderRule::kPaper, 0, true, true), (ChartBorder{0, 0}));
    EXPECT_EQ(border_of(BorderRule::kUniform, 0, false, true), (ChartBorder{1, 1}));
    EXPECT_EQ(border_of(BorderRule::kUniform, 3, false, true), (ChartBorder{4, 4}));
    EXPECT_EQ(border_of(BorderRule::kWhereRepeating, 2, false, true), (ChartBorder{0, 2}));
    EXPECT_EQ(border_of(BorderRule::kWhereRepeating, 0, true, false), (ChartBorder{1, 0}));
}

TEST(ChartBorder, CostsAsManyTexelsAsThePaperSays) {
    tests::Dice dice(1);
    for (uint32_t b = 0; b <= 4; ++b) {
        const RectangleSize interior = {dice.roll(1, 40), dice.roll(1, 40)};
        const auto padded = add_border(random_texels(dice, interior, 1), interior, 1, {b, b}, true, true);
        EXPECT_EQ(padded.size(), interior.area() + border_cost(interior, b));
        EXPECT_EQ(border_cost(interior, b), 2 * b * (interior.width + interior.height) + 4 * b * b);
        const auto uneven = add_border(random_texels(dice, interior, 1), interior, 1, {b, 0}, true, true);
        EXPECT_EQ(uneven.size(), interior.area() + border_cost(interior, ChartBorder{b, 0}));
    }
    // A 4 x 4 chart with b = 2 takes four times its texels (pitfall 8).
    EXPECT_EQ(border_cost({4, 4}, 2), 48u);
}

TEST(AddBorder, GivesTheWrappedTileWhereTheChartRepeatsAndItsEdgeWhereItDoesNot) {
    tests::Dice dice(2);
    for (const RectangleSize size : {RectangleSize{5, 7}, {1, 9}, {9, 1}, {1, 1}, {4, 4}, {3, 2}}) {
        for (uint32_t b = 1; b <= 4; ++b) {
            for (int wrap = 0; wrap < 4; ++wrap) {
                const bool repeat_u = wrap % 2 != 0, repeat_v = wrap / 2 != 0;
                const auto tile = random_texels(dice, size, 3);
                const auto padded = add_border(tile, size, 3, {b, b}, repeat_u, repeat_v);
                const auto source = [&](uint32_t at, uint32_t side, bool repeat) {
                    const auto place = static_cast<int64_t>(at) - b;
                    if (repeat) return static_cast<uint32_t>((place + int64_t{8} * side) % side);
                    return static_cast<uint32_t>(std::clamp<int64_t>(place, 0, int64_t{side} - 1));
                };
                for (uint32_t y = 0; y < size.height + 2 * b; ++y) {
                    for (uint32_t x = 0; x < size.width + 2 * b; ++x) {
                        for (uint32_t c = 0; c < 3; ++c) {
                            const uint32_t from =
                                source(y, size.height, repeat_v) * size.width + source(x, size.width, repeat_u);
                            ASSERT_EQ(padded[3 * (size_t{y} * (size.width + 2 * b) + x) + c], tile[3 * from + c]);
                        }
                    }
                }
            }
        }
    }
}

TEST(Alignment, IsFourTimesTwoToTheMipsForBlocks) {
    EXPECT_EQ(alignment_unit(0, true, true), 4u);
    EXPECT_EQ(alignment_unit(1, true, true), 8u);
    EXPECT_EQ(alignment_unit(2, true, true), 16u);
    EXPECT_EQ(alignment_unit(0, false, false), 1u);
    EXPECT_EQ(alignment_unit(1, false, true), 4u);
    EXPECT_EQ(alignment_unit(3, false, true), 8u);
}

}  // namespace
}  // namespace citystream::codec::atlas
