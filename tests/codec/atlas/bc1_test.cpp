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
    EXPECT_GT(gradient, 38.0);
    const double waves = psnr_of([](int x, int y, double rgb[3]) {
        rgb[0] = 128 + 100 * std::sin(x * 0.10) * std::cos(y * 0.07);
        rgb[1] = 128 + 90 * std::sin(x * 0.05 + y * 0.06);
        rgb[2] = 110 + 80 * std::cos(y * 0.09 - x * 0.02);
    });
    EXPECT_GT(waves, 36.0);
    std::mt19937 random(2);
    const double bricks = psnr_of([&random](int x, int y, double rgb[3]) {
        const bool mortar = y % 16 < 2 || (x + y / 16 % 2 * 16) % 32 < 2;
        const double noise = static_cast<double>(random() % 17) - 8;
        rgb[0] = (mortar ? 190 : 150) + noise;
        rgb[1] = (mortar ? 185 : 75) + noise;
        rgb[2] = (mortar ? 175 : 60) + noise;
    });
    EXPECT_GT(bricks, 36.0);
    RecordProperty("gradient_db", std::to_string(gradient));
    RecordProperty("waves_db", std::to_string(waves));
    RecordProperty("bricks_db", std::to_string(bricks));
    std::printf("PSNR: gradient %.2f dB, waves %.2f dB, bricks %.2f dB\n", gradient, waves, bricks);
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
