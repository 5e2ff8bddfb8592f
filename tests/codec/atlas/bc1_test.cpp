#include "codec/atlas/bc1.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

namespace citystream::codec::atlas {
namespace {

void expect_four_colour_mode(const uint32_t block[2]) {
    const uint32_t c0 = block[0] & 0xffffu;
    const uint32_t c1 = block[0] >> 16;
    EXPECT_TRUE(c0 > c1 || (c0 == c1 && block[1] == 0)) << c0 << " " << c1;
}

double block_square_error(const uint8_t rgb[48]) {
    uint32_t block[2];
    encode_bc1_block(rgb, block);
    expect_four_colour_mode(block);
    double sum = 0;
    for (uint32_t i = 0; i < 16; ++i) {
        uint8_t texel[3];
        decode_bc1_texel(block, i, texel);
        for (uint32_t c = 0; c < 3; ++c) sum += std::pow(texel[c] - rgb[3 * i + c], 2);
    }
    return sum;
}

using Paint = std::function<void(int x, int y, double rgb[3])>;

/// PSNR of a 256 x 256 image that `paint` gives.
double psnr_of(const Paint& paint) {
    double sum = 0;
    for (int by = 0; by < 256; by += 4) {
        for (int bx = 0; bx < 256; bx += 4) {
            uint8_t rgb[48];
            for (int i = 0; i < 16; ++i) {
                double colour[3];
                paint(bx + i % 4, by + i / 4, colour);
                for (int c = 0; c < 3; ++c)
                    rgb[3 * i + c] = static_cast<uint8_t>(std::clamp(std::lround(colour[c]), 0l, 255l));
            }
            sum += block_square_error(rgb);
        }
    }
    return 10 * std::log10(255.0 * 255.0 * 3 * 65536 / sum);
}

TEST(Bc1, DecoderFollowsTheIntegersOfTheFormat) {
    // c0 = (r 31, g 0, b 1), c1 = (r 0, g 63, b 0).
    const uint32_t block[2] = {(31u << 11 | 1u) | (63u << 5) << 16, 0b11'10'01'00u};
    const uint8_t expected[4][3] = {{255, 0, 8}, {0, 255, 0}, {170, 85, 5}, {85, 170, 3}};
    for (uint32_t i = 0; i < 4; ++i) {
        uint8_t rgb[3];
        decode_bc1_texel(block, i, rgb);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(rgb[c], expected[i][c]) << i;
    }
    const uint32_t swapped[2] = {block[0] << 16 | block[0] >> 16, 3u};
    uint8_t rgb[3];
    decode_bc1_texel(swapped, 0, rgb);
    EXPECT_EQ(rgb[0], 170) << "c0 < c1 is four-colour too";
}

TEST(Bc1, ConstantBlocksAreTheNearestThatTheFormatHas) {
    std::mt19937 random(1);
    int worst[3] = {};
    for (int round = 0; round < 3000; ++round) {
        uint8_t rgb[48];
        for (int c = 0; c < 3; ++c)
            rgb[c] = static_cast<uint8_t>(round < 256 ? static_cast<unsigned>(round) : random() & 255u);
        for (int i = 3; i < 48; ++i) rgb[i] = rgb[i % 3];
        uint32_t block[2];
        encode_bc1_block(rgb, block);
        expect_four_colour_mode(block);
        for (uint32_t i = 0; i < 16; ++i) {
            uint8_t texel[3];
            decode_bc1_texel(block, i, texel);
            for (int c = 0; c < 3; ++c) worst[c] = std::max(worst[c], std::abs(texel[c] - rgb[c]));
        }
    }
    // Thirds of the grids come within 1 of every value; plain endpoints would be off by up to 4 (5 bits) and 2 (6
    // bits).
    EXPECT_LE(worst[0], 1);
    EXPECT_LE(worst[1], 1);
    EXPECT_LE(worst[2], 1);
}

TEST(Bc1, BlackAndWhiteAreExact) {
    for (const int value : {0, 255}) {
        uint8_t rgb[48];
        std::fill(std::begin(rgb), std::end(rgb), static_cast<uint8_t>(value));
        EXPECT_EQ(block_square_error(rgb), 0.0);
    }
    uint8_t checker[48];
    for (int i = 0; i < 48; ++i) checker[i] = (i / 3 + i / 12) % 2 == 0 ? 0 : 255;
    EXPECT_EQ(block_square_error(checker), 0.0);
}

TEST(Bc1, QualityOnProceduralImages) {
    const double gradient = psnr_of([](int x, int y, double rgb[3]) {
        rgb[0] = x;
        rgb[1] = y;
        rgb[2] = 128;
    });
    EXPECT_GT(gradient, 46.4);
    const double waves = psnr_of([](int x, int y, double rgb[3]) {
        rgb[0] = 128 + 100 * std::sin(x * 0.10) * std::cos(y * 0.07);
        rgb[1] = 128 + 90 * std::sin(x * 0.05 + y * 0.06);
        rgb[2] = 110 + 80 * std::cos(y * 0.09 - x * 0.02);
    });
    EXPECT_GT(waves, 37.2);
    std::mt19937 random(2);
    const double bricks = psnr_of([&random](int x, int y, double rgb[3]) {
        const bool mortar = y % 16 < 2 || (x + y / 16 % 2 * 16) % 32 < 2;
        const double noise = static_cast<double>(random() % 17) - 8;
        rgb[0] = (mortar ? 190 : 150) + noise;
        rgb[1] = (mortar ? 185 : 75) + noise;
        rgb[2] = (mortar ? 175 : 60) + noise;
    });
    EXPECT_GT(bricks, 38.2);
    RecordProperty("gradient_db", std::to_string(gradient));
    RecordProperty("waves_db", std::to_string(waves));
    RecordProperty("bricks_db", std::to_string(bricks));
    std::printf("PSNR: gradient %.2f dB, waves %.2f dB, bricks %.2f dB\n", gradient, waves, bricks);
}

/// Blocks of every kind that encoders get wrong: noise, gradients, nearly flat, two colours, extremes.
std::vector<Bc1Texels> mixed_blocks(uint32_t seed, size_t count) {
    std::mt19937 random(seed);
    std::vector<Bc1Texels> blocks(count);
    for (size_t k = 0; k < count; ++k) {
        uint8_t rgb[48];
        const int kind = static_cast<int>(k % 6);
        int from[3], step_x[3], step_y[3];
        for (int c = 0; c < 3; ++c) {
            from[c] = static_cast<int>(random() % 256);
            step_x[c] = static_cast<int>(random() % 31) - 15;
            step_y[c] = static_cast<int>(random() % 31) - 15;
        }
        for (int i = 0; i < 16; ++i) {
            for (int c = 0; c < 3; ++c) {
                const auto noise = static_cast<int>(random() % 256);
                const int values[6] = {noise,
                                       from[c] + step_x[c] * (i % 4) + step_y[c] * (i / 4),
                                       from[c] + noise % 5,
                                       noise % 2 == 0 ? from[c] : 255 - from[c],
                                       noise % 3 == 0 ? 0 : 255,
                                       from[c]};
                rgb[3 * i + c] = static_cast<uint8_t>(std::clamp(values[kind], 0, 255));
            }
        }
        blocks[k] = bc1_texels(rgb);
    }
    return blocks;
}

uint32_t shown_error(const Bc1Texels& texels, const Bc1Block& block, const ChannelWeights& weights) {
    const uint32_t words[2] = {block.endpoints, block.indices};
    uint32_t sum = 0;
    for (uint32_t i = 0; i < 16; ++i) {
        uint8_t rgb[3];
        decode_bc1_texel(words, i, rgb);
        for (int c = 0; c < 3; ++c) {
            const int difference = rgb[c] - static_cast<int>(texels.channel[c][i]);
            sum += static_cast<uint32_t>(difference * difference) * weights.weight[c];
        }
    }
    return sum;
}

std::vector<Bc1Block> encode(const std::vector<Bc1Texels>& texels, const Bc1Options& options) {
    std::vector<Bc1Block> blocks(texels.size());
    encode_bc1_blocks(texels, options, blocks);
    return blocks;
}

TEST(Bc1, StatedErrorsAreThoseOfTheShownTexels) {
    const auto texels = mixed_blocks(5, 1200);
    for (const ChannelWeights& weights : {ChannelWeights{}, ChannelWeights{{3, 6, 1}}, ChannelWeights{{85, 85, 85}}}) {
        Bc1Options options;
        options.weights = weights;
        options.steps = weights.weight[0] == 3;
        const auto blocks = encode(texels, options);
        for (size_t k = 0; k < texels.size(); ++k) {
            const uint32_t words[2] = {blocks[k].endpoints, blocks[k].indices};
            expect_four_colour_mode(words);
            ASSERT_EQ(blocks[k].error, shown_error(texels[k], blocks[k], weights)) << k;
            // The halves of the fit say the truth too, for any endpoints and indices.
            const uint32_t other = blocks[(k + 1) % texels.size()].indices;
            const Bc1Block fitted = fit_bc1_endpoints(texels[k], weights, other);
            ASSERT_EQ(fitted.indices, other);
            ASSERT_EQ(fitted.error, shown_error(texels[k], fitted, weights)) << k;
            const Bc1Block ordered = ordered_bc1(fitted);
            if ((fitted.endpoints & 0xffffu) != fitted.endpoints >> 16) {
                ASSERT_EQ(fitted.error, shown_error(texels[k], ordered, weights)) << k;
            }
        }
    }
}

TEST(Bc1, BlocksDoNotDependOnTheBlocksBesideThem) {
    const auto texels = mixed_blocks(6, 203);
    const auto together = encode(texels, {});
    for (size_t k = 0; k < texels.size(); ++k) {
        const auto alone = encode({texels[k]}, {});
        ASSERT_EQ(alone[0].endpoints, together[k].endpoints) << k;
        ASSERT_EQ(alone[0].indices, together[k].indices) << k;
    }
}

TEST(Bc1, MoreEffortNeverRaisesABlocksError) {
    const auto texels = mixed_blocks(7, 1200);
    Bc1Options options;
    options.rounds = 1;
    const auto once = encode(texels, options);
    options.rounds = 4;
    const auto refined = encode(texels, options);
    options.steps = true;
    const auto stepped = encode(texels, options);
    options = {};
    options.search = PartitionSearch::kEven;
    const auto even = encode(texels, options);
    uint64_t all_error = 0, even_error = 0;
    for (size_t k = 0; k < texels.size(); ++k) {
        ASSERT_LE(refined[k].error, once[k].error);
        ASSERT_LE(stepped[k].error, refined[k].error);
        all_error += refined[k].error;
        even_error += even[k].error;
    }
    EXPECT_LT(all_error, even_error);
    EXPECT_LT(even_error, all_error + all_error / 50);
}

TEST(Bc1, NoPartitionByBruteForceIsMuchBetter) {
    // Every pair of endpoints on a coarse grid around the texels of grey blocks, against the encoder's.
    std::mt19937 random(8);
    uint64_t ours = 0, least = 0;
    for (int round = 0; round < 60; ++round) {
        uint8_t rgb[48];
        const auto low = static_cast<uint32_t>(random() % 150), span = static_cast<uint32_t>(4 + random() % 100);
        for (int i = 0; i < 16; ++i)
            rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = static_cast<uint8_t>(low + random() % span);
        const Bc1Texels texels = bc1_texels(rgb);
        ours += encode({texels}, {})[0].error;
        uint32_t best = ~0u;
        for (uint32_t a = 0; a < 32; ++a) {
            for (uint32_t b = 0; b <= a; ++b) {
                for (uint32_t green = 0; green < 16; ++green) {
                    const uint32_t ga = std::min(2 * a + green / 4, 65u) - 1, gb = std::min(2 * b + green % 4, 65u) - 1;
                    if (ga > 63 || gb > 63) continue;
                    const uint32_t endpoints = a << 11 | ga << 5 | a | (b << 11 | gb << 5 | b) << 16;
                    best = std::min(best, fit_bc1_indices(texels, {}, endpoints).error);
                }
            }
        }
        least += best;
    }
    std::printf("squared error: ours %llu, brute force %llu\n", static_cast<unsigned long long>(ours),
                static_cast<unsigned long long>(least));
    EXPECT_LE(ours, least + least / 25);
}

TEST(Bc1, WeightsMoveTheErrorToTheChannelsThatWeighLess) {
    const auto texels = mixed_blocks(9, 600);
    Bc1Options options;
    options.weights = {{1, 16, 1}};
    const auto plain = encode(texels, {}), weighted = encode(texels, options);
    const ChannelWeights green = {{0, 1, 0}};
    uint64_t plain_green = 0, weighted_green = 0;
    for (size_t k = 0; k < texels.size(); ++k) {
        plain_green += shown_error(texels[k], plain[k], green);
        weighted_green += shown_error(texels[k], weighted[k], green);
    }
    EXPECT_LT(weighted_green, plain_green * 8 / 10);
}

TEST(Bc1, ImagesOfAnySizeRepeatTheirLastColumnAndRow) {
    for (const uint32_t width : {1u, 3u, 4u, 9u}) {
        for (const uint32_t height : {1u, 2u, 4u, 7u}) {
            std::vector<uint8_t> rgb(3 * size_t{width} * height);
            for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<uint8_t>(37 * i);
            const auto blocks = bc1_blocks_of(rgb, width, height);
            const uint32_t across = (width + 3) / 4;
            ASSERT_EQ(blocks.size(), size_t{across} * ((height + 3) / 4));
            ASSERT_EQ(encode_bc1_image(rgb, width, height).size(), 2 * blocks.size());
            for (uint32_t y = 0; y < (height + 3) / 4 * 4; ++y) {
                for (uint32_t x = 0; x < across * 4; ++x) {
                    const size_t texel = size_t{std::min(y, height - 1)} * width + std::min(x, width - 1);
                    for (size_t c = 0; c < 3; ++c)
                        ASSERT_EQ(blocks[y / 4 * across + x / 4].channel[c][y % 4 * 4 + x % 4], rgb[3 * texel + c]);
                }
            }
        }
    }
}

TEST(Bc1, WordsOfKnownBlocksStayAsTheyAre) {
    uint64_t hash = 14695981039346656037u;
    for (const PartitionSearch search : {PartitionSearch::kAll, PartitionSearch::kEven}) {
        Bc1Options options;
        options.search = search;
        for (const Bc1Block& block : encode(mixed_blocks(10, 600), options))
            hash = ((hash ^ block.endpoints) * 1099511628211u ^ block.indices) * 1099511628211u;
    }
    EXPECT_EQ(hash, 0xcdfdd1d4749fcefcu) << std::hex << hash;
}

TEST(Bc1, TwoColoursOnTheGridOfEndpointsAreKeptExactly) {
    std::mt19937 random(4);
    for (int round = 0; round < 500; ++round) {
        // Any colours that a block has as its endpoints come back from any arrangement of them.
        uint32_t source[2] = {static_cast<uint32_t>(random()), 1u};
        uint8_t colours[2][3];
        decode_bc1_texel(source, 0, colours[0]);
        decode_bc1_texel(source, 1, colours[1]);
        uint8_t rgb[48];
        for (int i = 0; i < 16; ++i) std::copy_n(colours[i == 0 ? 0 : i == 1 ? 1 : random() & 1u], 3, rgb + 3 * i);
        EXPECT_EQ(block_square_error(rgb), 0.0) << round;
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
