#include "codec/atlas/chart_content.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "codec/atlas/block_planes.h"

namespace citystream::codec::atlas {
namespace {

TEST(ChartContent, OneColourIsFoundWithinItsTolerance) {
    std::vector<uint8_t> rgb;
    for (int i = 0; i < 100; ++i) rgb.insert(rgb.end(), {10, 20, static_cast<uint8_t>(30 + i % 3)});
    EXPECT_FALSE(flat_colour(rgb));
    const auto colour = flat_colour(rgb, 1);
    ASSERT_TRUE(colour);
    EXPECT_EQ(*colour, (std::array<uint8_t, 3>{10, 20, 31}));
    rgb[150] = 14;
    EXPECT_FALSE(flat_colour(rgb, 1));
    EXPECT_TRUE(flat_colour(std::span(rgb).first(3)));
}

TEST(ChartContent, EqualChainsAreFoundAndOthersAreNot) {
    const std::vector<uint32_t> a = {1, 2, 3, 4}, b = {1, 2, 3, 5}, c = a, d = {1, 2, 3};
    const std::vector<BlockChain> chains = {{{4, 0}, a}, {{4, 0}, b}, {{4, 0}, c},
                                            {{2, 1}, a}, {{4, 0}, d}, {{4, 0}, b}};
    for (size_t i = 0; i < chains.size(); ++i) {
        for (size_t k = 0; k < i; ++k) {
            const bool equal = (k == 0 && i == 2) || (k == 1 && i == 5);
            EXPECT_EQ(content_hash(chains[i]) == content_hash(chains[k]), equal) << i << " and " << k;
        }
    }
}

TEST(ChartContent, HashDependsOnEveryBit) {
    std::vector<uint32_t> words(33, 0);
    std::set<ContentHash> seen = {content_hash({{1, 2}, words})};
    for (uint32_t& word : words) {
        for (uint32_t bit = 0; bit < 32; ++bit) {
            word ^= 1u << bit;
            EXPECT_TRUE(seen.insert(content_hash({{1, 2}, words})).second);
            word ^= 1u << bit;
        }
    }
    for (size_t length = 0; length < words.size(); ++length)
        EXPECT_TRUE(seen.insert(content_hash({{1, 2}, std::span(words).first(length)})).second) << "zeros count";
    EXPECT_TRUE(seen.insert(content_hash({{2, 1}, words})).second);
}

TEST(ChartContent, HashIsTheSameOnEveryMachine) {
    const std::vector<uint32_t> words = {0x01234567, 0x89abcdef, 0xfedcba98};
    const ContentHash hash = content_hash({{7, 9}, words});
    EXPECT_EQ(hash.low, 0x205ae3cede0cd006u) << std::hex << hash.low;
    EXPECT_EQ(hash.high, 0xf5201cc70d123a46u) << std::hex << hash.high;
}

TEST(BlockPlanes, SplitAndJoinAreInverse) {
    std::mt19937 random(1);
    for (const uint32_t block_words : {1u, 2u, 4u}) {
        for (const size_t blocks : {0, 1, 7, 64}) {
            std::vector<uint32_t> words(blocks * block_words), planes(words.size()), back(words.size());
            for (uint32_t& word : words) word = static_cast<uint32_t>(random());
            split_block_planes(words, block_words, planes);
            join_block_planes(planes, block_words, back);
            EXPECT_EQ(back, words);
            if (blocks > 1 && block_words > 1) {
                EXPECT_EQ(planes[1], words[block_words]);
                EXPECT_EQ(planes[blocks], words[1]);
            }
        }
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
