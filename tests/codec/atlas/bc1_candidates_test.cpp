#include "codec/atlas/bc1_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "codec/atlas/bc1.h"

namespace citystream::codec::atlas {
namespace {

constexpr ChannelWeights kWeights[] = {{{1, 1, 1}}, {{3, 6, 1}}, {{85, 85, 85}}};

/// Noise, near colours, black and white, one colour.
std::vector<Bc1Texels> test_blocks() {
    std::mt19937 random(3);
    std::vector<Bc1Texels> blocks;
    for (int kind = 0; kind < 4; ++kind) {
        for (int i = 0; i < 8; ++i) {
            Bc1Texels& texels = blocks.emplace_back();
            const auto base = static_cast<int>(random() % 200);
            for (auto& channel : texels.channel) {
                for (float& value : channel) {
                    const auto noise = static_cast<int>(random() % 256);
                    const int values[4] = {noise, base + noise % 40, noise % 2 * 255, base};
                    value = static_cast<float>(values[kind]);
                }
            }
        }
    }
    return blocks;
}

/// 21 words, so that the last lanes are not all used; extremes among them.
std::vector<uint32_t> test_words(std::mt19937& random) {
    std::vector<uint32_t> words = {0, ~uint32_t{0}, 0xffffu, 0xffff0000u};
    while (words.size() < 21) words.push_back(static_cast<uint32_t>(random()));
    return words;
}

uint32_t texel_error(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints, uint32_t code,
                     uint32_t i) {
    const uint32_t block[2] = {endpoints, code << (2 * i)};
    uint8_t rgb[3];
    decode_bc1_texel(block, i, rgb);
    uint32_t error = 0;
    for (int c = 0; c < 3; ++c) {
        const int difference = rgb[c] - static_cast<int>(texels.channel[c][i]);
        error += weights.weight[c] * static_cast<uint32_t>(difference * difference);
    }
    return error;
}

uint32_t shown_error(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints, uint32_t indices) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < 16; ++i) sum += texel_error(texels, weights, endpoints, indices >> (2 * i) & 3u, i);
    return sum;
}

TEST(Bc1Candidates, LeastErrorsAreThoseOfTheNearestColoursAndTheBoundsAreNotAboveThem) {
    std::mt19937 random(4);
    for (const ChannelWeights& weights : kWeights) {
        for (const Bc1Texels& texels : test_blocks()) {
            const std::vector<uint32_t> words = test_words(random);
            std::vector<uint32_t> errors(words.size());
            std::vector<int32_t> bounds(words.size());
            least_bc1_errors(texels, weights, words, errors);
            bound_bc1_errors(texels, weights, words, bounds);
            for (size_t k = 0; k < words.size(); ++k) {
                uint32_t expected = 0;
                for (uint32_t i = 0; i < 16; ++i) {
                    uint32_t nearest = UINT32_MAX;
                    for (uint32_t code = 0; code < 4; ++code)
                        nearest = std::min(nearest, texel_error(texels, weights, words[k], code, i));
                    expected += nearest;
                }
                ASSERT_EQ(errors[k], expected) << words[k];
                ASSERT_GE(bounds[k], 0);
                ASSERT_LE(static_cast<uint32_t>(bounds[k]), expected) << words[k];
            }
        }
    }
}

TEST(Bc1Candidates, RowErrorsAddUpToTheErrorOfAnyIndexWord) {
    std::mt19937 random(5);
    for (const ChannelWeights& weights : kWeights) {
        for (const Bc1Texels& texels : test_blocks()) {
            const auto endpoints = static_cast<uint32_t>(random());
            const Bc1RowErrors rows(texels, weights, endpoints);
            const std::vector<uint32_t> words = test_words(random);
            std::vector<uint32_t> costs;
            for (size_t k = 0; k < words.size(); ++k) costs.push_back(static_cast<uint32_t>(random()) >> 2);
            std::vector<uint64_t> js(words.size());
            const uint64_t least = rows.weigh(words, costs, js);
            for (size_t k = 0; k < words.size(); ++k) {
                const uint32_t error = shown_error(texels, weights, endpoints, words[k]);
                ASSERT_EQ(rows.of(words[k]), error);
                ASSERT_EQ(js[k], uint64_t{error} * kErrorUnits + costs[k]);
            }
            EXPECT_EQ(least, *std::min_element(js.begin(), js.end()));
        }
    }
}

TEST(Bc1Candidates, CheapestIsTheFirstOfTheBestBytesInEveryRow) {
    std::mt19937 random(6);
    for (const Bc1Texels& texels : test_blocks()) {
        const auto endpoints = static_cast<uint32_t>(random());
        const Bc1RowErrors rows(texels, {}, endpoints);
        std::array<int32_t, 256> costs;
        for (int32_t& cost : costs) cost = static_cast<int32_t>(random() % 4) * 1000;
        const uint32_t word = rows.cheapest(costs);
        for (uint32_t row = 0; row < 4; ++row) {
            // Beside the row's byte all others are 0, which adds the same to each.
            int64_t least = INT64_MAX;
            uint32_t first = 0;
            for (uint32_t byte = 0; byte < 256; ++byte) {
                const int64_t j = int64_t{rows.of(byte << (8 * row))} * kErrorUnits + costs[byte];
                if (j >= least) continue;
                least = j;
                first = byte;
            }
            ASSERT_EQ(word >> (8 * row) & 255u, first) << "row " << row;
        }
    }
}

TEST(Bc1Candidates, NoCandidatesGiveNothing) {
    const Bc1Texels texels = test_blocks().front();
    least_bc1_errors(texels, {}, {}, {});
    bound_bc1_errors(texels, {}, {}, {});
    EXPECT_GT(Bc1RowErrors(texels, {}, 0).weigh({}, {}, {}), uint64_t{1} << 62);
}

}  // namespace
}  // namespace citystream::codec::atlas
