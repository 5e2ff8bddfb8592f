#include "codec/facade/facade_layer.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "codec/chart_word.h"
#include "tests/codec/damage.h"

namespace citystream::codec::facade {
namespace {

FacadeTile two_walls() {
    FacadeTile tile;
    tile.palettes.resize(2);
    for (uint32_t i = 0; i < FACADE_PALETTE_SLOTS; ++i) {
        tile.palettes[0].slots[i] = {i % 3, 2.5f};
        tile.palettes[1].slots[i] = {0, 0};
    }
    tile.placements = {{{0, -5, 100}, {10240, 0}, 9216, 3, 1}, {{-70000, 80000, 0}, {-3, 4096}, 30720, 0, 0}};
    return tile;
}

std::vector<uint32_t> words_of(const FacadeTile& tile) {
    return encode_facades(tile).at(0).words;
}

TEST(FacadeLayer, GivesBackPlacementsAndPalettes) {
    const LayerSteps steps = encode_facades(two_walls());
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps[0].error, 0.0f);
    const auto back = decode_facades(steps[0].words, 4, 3);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, two_walls());
}

TEST(FacadeLayer, EmptyTileIsEightWords) {
    const std::vector<uint32_t> words = words_of({});
    EXPECT_EQ(words, (std::vector<uint32_t>{0x31505343u, 0, 0, 8, 8, 0, 0, 0}));
    const auto back = decode_facades(words, 0, 0);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(*back, FacadeTile{});
}

TEST(FacadeLayer, GoldenWordsOfOnePlacement) {
    FacadeTile tile = two_walls();
    const std::vector<uint32_t> words = words_of(tile);
    ASSERT_EQ(words.size(), 8u + 2 * 32 + 2 * 8);
    EXPECT_EQ(std::vector<uint32_t>(words.begin(), words.begin() + 12),
              (std::vector<uint32_t>{0x31505343u, 2, 2, 72, 8, 0, 0, 0, 0, 0x40200000u, 1, 0x40200000u}));
    EXPECT_EQ(std::vector<uint32_t>(words.begin() + 72, words.begin() + 80),
              (std::vector<uint32_t>{0, 0xfffffffbu, 100, 10240, 0, 9216, 3, 1}));
}

TEST(FacadeLayer, RefusesWhatIsNotInDictionaryAtlasOrPalettes) {
    const std::vector<uint32_t> words = words_of(two_walls());
    EXPECT_FALSE(decode_facades(words, 3, 3).ok()) << "map 3 of 3";
    EXPECT_FALSE(decode_facades(words, 4, 2).ok()) << "chart 2 of 2";
    FacadeTile coloured = two_walls();
    for (Palette& palette : coloured.palettes) {
        for (PaletteEntry& entry : palette.slots) entry.chart_word = colour_word({1, 2, 3});
    }
    EXPECT_TRUE(decode_facades(words_of(coloured), 4, 0).ok()) << "colours need no chart";
    coloured.palettes[0].slots[0].chart_word |= 1U << 24;
    EXPECT_FALSE(decode_facades(words_of(coloured), 4, 3).ok()) << "neither chart nor colour";
    FacadeTile tile = two_walls();
    tile.placements[0].palette = 2;
    EXPECT_FALSE(decode_facades(words_of(tile), 4, 3).ok());
    tile = two_walls();
    tile.placements[1].along[0] = std::numeric_limits<int32_t>::min();
    EXPECT_FALSE(decode_facades(words_of(tile), 4, 3).ok());
    tile = two_walls();
    tile.placements[1].height = 0x80000000u;
    EXPECT_FALSE(decode_facades(words_of(tile), 4, 3).ok());
    for (const float length :
         {-1.0f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        tile = two_walls();
        tile.palettes[1].slots[7].metres_per_repeat = length;
        const auto back = decode_facades(words_of(tile), 4, 3);
        ASSERT_FALSE(back.ok());
        EXPECT_EQ(back.error().offset, 4u * (8 + 32 + 15));
    }
}

TEST(FacadeLayer, RefusesEveryTruncationAndSurvivesEveryMutation) {
    const std::vector<uint32_t> words = words_of(two_walls());
    for (size_t size = 0; size < words.size(); ++size) {
        EXPECT_FALSE(decode_facades(exact_copy(std::span(words).first(size)), 4, 3).ok()) << size;
    }
    size_t accepted = 0;
    size_t refused = 0;
    for_each_mutation(words, [&](std::span<const uint32_t> damaged) {
        const auto back = decode_facades(damaged, 4, 3);
        ++(back.ok() ? accepted : refused);
        if (!back.ok()) return;
        for (const Placement& placement : back->placements) {
            EXPECT_LT(placement.map, 4u);
            EXPECT_LT(placement.palette, back->palettes.size());
        }
    });
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
}

}  // namespace
}  // namespace citystream::codec::facade
