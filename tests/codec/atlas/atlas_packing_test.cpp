#include "codec/atlas/atlas_packing.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/atlas_layout.h"
#include "codec/bits/zstd_frame.h"
#include "codec/step_wire.h"

namespace citystream::codec::atlas {
namespace {

using Bytes = std::vector<std::byte>;

/// A wall of bricks whose colours wander, so that blocks recur in parts but not as a whole.
ChartImage bricks(uint32_t width, uint32_t height, uint32_t seed) {
    std::mt19937 random(seed);
    ChartImage image{width, height, true, false, 0.02F, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const bool joint = y % 6 == 0 || (x + y / 6 * 5) % 11 == 0;
            const auto noise = static_cast<uint32_t>(random() % 24);
            image.rgb.push_back(static_cast<uint8_t>((joint ? 190 : 140) + noise));
            image.rgb.push_back(static_cast<uint8_t>((joint ? 180 : 60) + noise));
            image.rgb.push_back(static_cast<uint8_t>((joint ? 170 : 40) + noise));
        }
    }
    return image;
}

LayerSteps wall_steps(uint32_t strength = 0) {
    const std::vector<ChartImage> charts = {bricks(200, 120, 1), bricks(1, 1, 2), bricks(64, 256, 3)};
    return encode_atlas(charts, {strength});
}

TEST(PackAtlasStep, EveryStepComesBackWordByWord) {
    for (const uint32_t strength : {0U, 10U}) {
        const LayerSteps steps = wall_steps(strength);
        ASSERT_GT(steps.size(), 2U);
        for (uint32_t i = 0; i < steps.size(); ++i) {
            const auto packed = pack_atlas_step(steps[0].words, i, steps[i].words);
            ASSERT_TRUE(packed) << i;
            EXPECT_GT(packed->size(), 4 * steps[i].words.size()) << "else it would be taken for the words";
            EXPECT_LE(packed->size(), most_packed_atlas_bytes(steps[i].words.size()));
            const auto back = unpack_atlas_step(*packed, steps[i].words.size());
            ASSERT_TRUE(back.ok()) << back.error().text();
            EXPECT_EQ(*back, steps[i].words) << i;
        }
    }
}

TEST(PackAtlasStep, AnAtlasWithoutChartsPacksToo) {
    const LayerSteps steps = encode_atlas({});
    const auto packed = pack_atlas_step(steps[0].words, 0, steps[0].words);
    ASSERT_TRUE(packed);
    EXPECT_EQ(unpack_atlas_step(*packed, steps[0].words.size()).value(), steps[0].words);
}

TEST(PackAtlasStep, TheExampleOfTheFormatIsThis) {
    const ChartImage white{5, 4, false, true, 1, std::vector<uint8_t>(60, 255)};
    const ChartImage black{1, 1, true, true, 2, {0, 0, 0}};
    const LayerSteps steps = encode_atlas(std::vector<ChartImage>{white, black});
    const auto packed = pack_atlas_step(steps[0].words, 0, steps[0].words);
    ASSERT_TRUE(packed);
    std::vector<uint32_t> words(packed->size() / 4);
    std::memcpy(words.data(), packed->data(), packed->size());
    std::vector<uint32_t> expected = {0x50415343, 3, 30, 1, 2, 1, 2, 3};
    expected.insert(expected.end(), steps[0].words.begin(), steps[0].words.begin() + 30);
    for (const uint32_t word : {2U, 0U, 2U, 6U}) expected.push_back(word);  // tables of mips 1, 0
    for (const uint32_t word : {~0U, ~0U, ~0U, ~0U, 0U, 0U, 0U, 0U, 0U, 0U}) expected.push_back(word);  // planes
    EXPECT_EQ(words, expected);
}

TEST(PackAtlasStep, LeavesEverythingElseAsItIs) {
    const LayerSteps steps = wall_steps();
    EXPECT_FALSE(pack_atlas_step(std::span(steps[0].words).first(10), 0, std::span(steps[0].words).first(10)));
    EXPECT_FALSE(pack_atlas_step(steps[0].words, static_cast<uint32_t>(steps.size()), steps[1].words));
    EXPECT_FALSE(pack_atlas_step(steps[0].words, 1, std::span(steps[1].words).first(4))) << "an odd number of words";
    EXPECT_FALSE(pack_atlas_step(steps[0].words, 1, std::span(steps[1].words).first(2))) << "less than its table";
    for (const size_t word : {size_t{ATLAS_WORD_MAGIC}, size_t{ATLAS_WORD_CHART_COUNT}, size_t{ATLAS_WORD_MIP_COUNT},
                              size_t{ATLAS_WORD_STEP0_MIP}, size_t{ATLAS_WORD_MIP_TABLE}}) {
        std::vector<uint32_t> other = steps[0].words;
        other[word] = 0xfffffffeU;
        EXPECT_FALSE(pack_atlas_step(other, 0, other)) << word;
    }
}

TEST(EncodeSteps, BlocksInPlanesTravelInFewerBytes) {
    const LayerSteps steps = wall_steps();
    size_t planes = 0, plain = 0;
    const auto frames = encode_steps(steps);
    ASSERT_EQ(frames.size(), steps.size());
    for (size_t i = 0; i < steps.size(); ++i) {
        const size_t alone = bits::compress_frame(std::as_bytes(std::span(steps[i].words))).size();
        planes += frames[i].size();
        plain += alone;
        EXPECT_EQ(decode_step(frames[i], 4 * steps[i].words.size()).value(), steps[i].words) << i;
        if (steps[i].words.size() < 2000) {
            EXPECT_LE(frames[i].size(), alone) << "the smaller one of the two";
        }
        EXPECT_FALSE(decode_step(frames[i], 4 * steps[i].words.size() + 4).ok());
        EXPECT_FALSE(decode_step(frames[i], 4 * steps[i].words.size() - 4).ok());
    }
    EXPECT_LT(planes, plain);
}

TEST(EncodeSteps, RateDistortionMakesThemSmallerStill) {
    size_t best = 0, cheaper = 0;
    for (const Bytes& frame : encode_steps(wall_steps())) best += frame.size();
    for (const Bytes& frame : encode_steps(wall_steps(20))) cheaper += frame.size();
    EXPECT_LT(10 * cheaper, 9 * best);
}

TEST(UnpackAtlasStep, DamagedBytesGiveTheSaidNumberOfWordsOrAnError) {
    std::mt19937 random(5);
    const LayerSteps steps = wall_steps();
    const auto& words = steps[0].words;
    const Bytes packed = pack_atlas_step(words, 0, words).value();
    for (size_t size = 0; size < packed.size(); ++size)
        EXPECT_FALSE(unpack_atlas_step(std::span(packed).first(size), words.size()).ok()) << size;
    size_t accepted = 0;
    for (int i = 0; i < 20000; ++i) {
        Bytes damaged = packed;
        const size_t at = i % 2 == 0 ? random() % 60 : random() % damaged.size();
        damaged[at] ^= static_cast<std::byte>(1 + random() % 255);
        const auto back = unpack_atlas_step(damaged, words.size());
        if (!back) continue;
        ++accepted;
        ASSERT_EQ(back->size(), words.size());
    }
    EXPECT_GT(accepted, 0U);
    EXPECT_FALSE(unpack_atlas_step(packed, words.size() + 1).ok());
    EXPECT_FALSE(unpack_atlas_step(packed, 0).ok());
}

}  // namespace
}  // namespace citystream::codec::atlas
