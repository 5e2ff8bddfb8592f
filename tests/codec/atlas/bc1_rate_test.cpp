#include "codec/atlas/bc1_rate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "codec/atlas/block_planes.h"
#include "codec/atlas/word_rate.h"
#include "codec/bits/zstd_frame.h"

namespace citystream::codec::atlas {
namespace {

using Image = std::vector<uint8_t>;
constexpr uint32_t kSide = 128;

template <typename Paint>
Image paint(Paint colour) {
    Image image(3 * size_t{kSide} * kSide);
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            for (uint32_t c = 0; c < 3; ++c)
                image[3 * (size_t{y} * kSide + x) + c] = static_cast<uint8_t>(std::clamp(colour(x, y, c), 0, 255));
        }
    }
    return image;
}

int as_int(uint64_t value) {
    return static_cast<int>(value);
}

Image bricks(uint32_t seed) {
    std::mt19937 random(seed);
    int noise = 0;
    return paint([&](uint32_t x, uint32_t y, uint32_t c) {
        const int mortar[3] = {190, 185, 175}, brick[3] = {150, 75, 60};
        if (c == 0) noise = as_int(random() % 17) - 8;
        return (y % 16 < 2 || (x + y / 16 % 2 * 16) % 32 < 2 ? mortar : brick)[c] + noise;
    });
}

/// Random, flat, gradient, extreme.
std::vector<Image> test_images() {
    std::mt19937 random(1);
    return {paint([&](uint32_t, uint32_t, uint32_t) { return as_int(random() % 256); }),
            paint([](uint32_t, uint32_t, uint32_t c) { return 77 + 30 * as_int(c); }),
            paint([](uint32_t x, uint32_t y, uint32_t c) {
                return as_int(c == 0 ? 2 * x : c == 1 ? 2 * y : x + y);
            }),
            paint([&](uint32_t, uint32_t, uint32_t) { return random() % 2 == 0 ? 0 : 255; }), bricks(2)};
}

uint64_t shown_error(const Bc1Texels& texels, const uint32_t block[2]) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < 16; ++i) {
        uint8_t rgb[3];
        decode_bc1_texel(block, i, rgb);
        for (int c = 0; c < 3; ++c) {
            const int difference = rgb[c] - static_cast<int>(texels.channel[c][i]);
            sum += static_cast<uint64_t>(difference * difference);
        }
    }
    return sum;
}

size_t wire_bytes(const std::vector<uint32_t>& words) {
    std::vector<uint32_t> planes(words.size());
    split_block_planes(words, 2, planes);
    return bits::compress_frame(std::as_bytes(std::span(planes))).size();
}

TEST(Bc1Rate, NoBlocksErrorRisesByMoreThanTheBound) {
    for (const Image& image : test_images()) {
        const auto texels = bc1_blocks_of(image, kSide, kSide);
        std::vector<Bc1Block> best(texels.size());
        encode_bc1_blocks(texels, {}, best);
        for (const uint32_t lambda : {0u, 8u, 300u, 1u << 20, ~0u}) {
            for (const uint32_t rise : {0u, 1u, 64u, 100000u}) {
                Bc1RateOptions options;
                options.lambda = lambda;
                options.most_rise_per_texel = rise;
                options.window = 64;
                Bc1RateEncoder encoder(options);
                const auto words = encoder.encode(texels);
                ASSERT_EQ(words.size(), 2 * texels.size());
                uint64_t sum = 0, largest = 0;
                for (size_t k = 0; k < texels.size(); ++k) {
                    const uint32_t* block = &words[2 * k];
                    const uint32_t c0 = block[0] & 0xffffu, c1 = block[0] >> 16;
                    ASSERT_TRUE(c0 > c1 || (c0 == c1 && block[1] == 0)) << k;
                    const uint64_t error = shown_error(texels[k], block);
                    sum += error;
                    if (error > best[k].error) largest = std::max(largest, error - best[k].error);
                    ASSERT_LE(error, best[k].error + uint64_t{16} * rise) << k << " lambda " << lambda;
                }
                EXPECT_EQ(encoder.totals().error, sum);
                EXPECT_EQ(encoder.totals().largest_rise, largest);
                EXPECT_EQ(encoder.totals().blocks, texels.size());
            }
        }
    }
}

TEST(Bc1Rate, WithoutLambdaTheBestBlocksStay) {
    const Image image = bricks(3);
    Bc1RateOptions options;
    options.lambda = 0;
    EXPECT_EQ(Bc1RateEncoder(options).encode(bc1_blocks_of(image, kSide, kSide)),
              encode_bc1_image(image, kSide, kSide));
}

TEST(Bc1Rate, BytesFallWithLambdaAndTheErrorRisesLittle) {
    const Image image = bricks(4);
    const auto texels = bc1_blocks_of(image, kSide, kSide);
    const auto best = encode_bc1_image(image, kSide, kSide);
    size_t before = wire_bytes(best);
    EXPECT_LT(before, bits::compress_frame(std::as_bytes(std::span(best))).size()) << "planes alone";
    const size_t whole = before;
    for (const uint32_t lambda : {4u, 16u, 64u}) {
        Bc1RateOptions options;
        options.lambda = lambda;
        Bc1RateEncoder encoder(options);
        const size_t bytes = wire_bytes(encoder.encode(texels));
        const Bc1RateTotals& totals = encoder.totals();
        const double loss = bc1_psnr(totals.best_error, totals.blocks) - bc1_psnr(totals.error, totals.blocks);
        std::printf("lambda %u: %zu of %zu bytes, %.2f dB less\n", lambda, bytes, whole, loss);
        EXPECT_LT(bytes, before);
        if (lambda == 16) {
            EXPECT_LT(bytes, whole * 80 / 100);
            EXPECT_LT(loss, 1.0);
        }
        before = bytes;
    }
}

TEST(Bc1Rate, AnImageThatComesAgainCostsNextToNothing) {
    const Image image = bricks(5);
    const auto texels = bc1_blocks_of(image, kSide, kSide);
    Bc1RateEncoder encoder({});
    const auto first = encoder.encode(texels);
    auto both = first;
    const auto second = encoder.encode(texels);
    both.insert(both.end(), second.begin(), second.end());
    EXPECT_LT(wire_bytes(both), wire_bytes(first) * 12 / 10);
}

TEST(Bc1Rate, TheSameBlocksGiveTheSameWords) {
    const auto texels = bc1_blocks_of(bricks(6), kSide, kSide);
    Bc1RateEncoder a({}), b({});
    const auto words = a.encode(texels);
    EXPECT_EQ(words, b.encode(texels));
    uint64_t hash = 14695981039346656037u;
    for (const uint32_t word : words) hash = (hash ^ word) * 1099511628211u;
    EXPECT_EQ(hash, 0x6fd42d4cc996e1b1u) << std::hex << hash;
}

TEST(Bc1Rate, PsnrIsThatOfTheMeanSquaredError) {
    EXPECT_EQ(bc1_psnr(0, 5), 99.0);
    EXPECT_NEAR(bc1_psnr(48 * 7, 7), 48.1308, 1e-4);
}

TEST(Bc1Rate, NothingToEncodeGivesNothing) {
    Bc1RateEncoder encoder({});
    EXPECT_TRUE(encoder.encode({}).empty());
    EXPECT_EQ(encoder.totals().blocks, 0u);
}

TEST(WordRate, LogarithmIsWithinASixteenth) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 20000; ++round) {
        const uint64_t value = std::max<uint64_t>(random() >> (random() % 64), 1);
        ASSERT_NEAR(log2_sixteenths(value), 16 * std::log2(static_cast<double>(value)), 1.0) << value;
    }
}

TEST(WordRate, WhatOccurredBeforeCostsLessAndWhatGoesOnLeast) {
    WordRate rate(8);
    std::mt19937 random(8);
    std::vector<uint32_t> words(300);
    for (uint32_t& word : words) word = static_cast<uint32_t>(random());
    rate.expect(words);
    for (const uint32_t word : words) rate.append(word);
    const uint32_t fresh = rate.cost(0x12345678u);
    EXPECT_NEAR(fresh, 4 * 8 * 16, 60) << "random bytes take about 8 bits each";
    EXPECT_LT(rate.cost(words[5]), fresh);
    EXPECT_LT(rate.cost(words[298]), rate.cost(words[5])) << "nearer is cheaper";
    rate.append(words[5]);
    uint32_t next = 0;
    ASSERT_TRUE(rate.continuation(next));
    EXPECT_EQ(next, words[6]);
    EXPECT_LT(rate.cost(words[6]), 32u);
    rate.append(words[6]);
    EXPECT_LT(rate.cost(words[7]), 32u);
    ASSERT_EQ(rate.recent().size(), 8u);
    EXPECT_EQ(rate.recent()[0], words[6]);
    EXPECT_EQ(rate.recent()[1], words[5]);
    EXPECT_EQ(rate.recent()[2], words[299]);
    std::vector<uint32_t> costs;
    rate.recent_costs(costs);
    for (size_t i = 0; i < costs.size(); ++i) EXPECT_EQ(costs[i], rate.cost(rate.recent()[i]));
}

TEST(WordRate, NoWordCostsLessThanTheStatedLeast) {
    std::mt19937 random(9);
    WordRate rate(16);
    std::vector<uint32_t> costs;
    for (int round = 0; round < 3000; ++round) {
        // Few words, some rare, and now and then a run of what was there before.
        const uint32_t word = round % 100 < 40 && round > 200 ? rate[rate.size() - 57]
                                                              : static_cast<uint32_t>(random() % (1u << random() % 12));
        uint32_t next = 0;
        const bool goes_on = rate.continuation(next);
        ASSERT_GE(rate.cost(word), rate.least_cost());
        const auto recent = rate.recent();
        const bool other = std::find(recent.begin(), recent.end(), word) == recent.end() && !(goes_on && word == next);
        if (goes_on && other) {
            ASSERT_GE(rate.cost(word), rate.least_other_cost());
        }
        rate.recent_costs(costs, 3);
        for (size_t i = 0; i < costs.size(); ++i) ASSERT_EQ(costs[i], 3 * rate.cost(recent[i])) << round;
        rate.append(word);
    }
}

TEST(WordPositions, RemembersTheLastPlaceOfEveryWord) {
    std::mt19937 random(10);
    WordPositions positions;
    std::map<uint32_t, uint32_t> expected;
    EXPECT_EQ(positions.find(0), WordPositions::kNone);
    for (uint32_t i = 0; i < 20000; ++i) {
        const auto word = static_cast<uint32_t>(random()) >> (random() % 32);
        const auto found = expected.find(word);
        ASSERT_EQ(positions.find(word), found == expected.end() ? WordPositions::kNone : found->second);
        positions.set(word, i);
        expected[word] = i;
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
