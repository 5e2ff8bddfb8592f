#include "codec/atlas/bc1_cutout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace citystream::codec::atlas {
namespace {

struct Shown {
    uint8_t rgba[16][4];
};

Shown round_trip(const uint8_t rgba[64]) {
    uint32_t block[2];
    encode_bc1_cutout_block(rgba, {}, block);
    Shown shown;
    for (uint32_t i = 0; i < 16; ++i) decode_bc1_cutout_texel(block, i, shown.rgba[i]);
    return shown;
}

TEST(Bc1Cutout, ExactlyTheTexelsBelowHalfAlphaAreGone) {
    std::mt19937 random(1);
    for (int round = 0; round < 3000; ++round) {
        uint8_t rgba[64];
        for (uint8_t& value : rgba) value = static_cast<uint8_t>(random());
        if (round % 7 == 0)
            for (int i = 0; i < 16; ++i) rgba[4 * i + 3] = round % 2 == 0 ? 0 : 255;
        const Shown shown = round_trip(rgba);
        for (int i = 0; i < 16; ++i) {
            ASSERT_EQ(shown.rgba[i][3], rgba[4 * i + 3] < 128 ? 0 : 255) << round << " " << i;
            if (shown.rgba[i][3] != 0) continue;
            for (int c = 0; c < 3; ++c) ASSERT_EQ(shown.rgba[i][c], 0);
        }
    }
}

TEST(Bc1Cutout, OpaqueBlocksAreThoseOfTheFourColourEncoder) {
    std::mt19937 random(2);
    for (int round = 0; round < 500; ++round) {
        uint8_t rgba[64], rgb[48];
        for (int i = 0; i < 16; ++i) {
            for (int c = 0; c < 3; ++c) rgba[4 * i + c] = rgb[3 * i + c] = static_cast<uint8_t>(random() % 64 + 90);
            rgba[4 * i + 3] = 255;
        }
        if (round == 0) std::fill(std::begin(rgba), std::end(rgba), uint8_t{255});
        if (round == 0) std::fill(std::begin(rgb), std::end(rgb), uint8_t{255});
        uint32_t block[2], expected[2];
        encode_bc1_cutout_block(rgba, {}, block);
        encode_bc1_block(rgb, expected);
        EXPECT_EQ(block[0], expected[0]);
        EXPECT_EQ(block[1], expected[1]);
        for (uint32_t i = 0; i < 16; ++i) {
            uint8_t shown[4], opaque[3];
            decode_bc1_cutout_texel(block, i, shown);
            decode_bc1_texel(expected, i, opaque);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(shown[c], opaque[c]) << "also where c0 == c1";
        }
    }
}

TEST(Bc1Cutout, ColoursBesideHolesAreAsGoodAsThreeColoursAllow) {
    std::mt19937 random(3);
    double sum = 0;
    for (int round = 0; round < 2000; ++round) {
        uint8_t rgba[64];
        const int base = 60 + static_cast<int>(random() % 100);
        for (int i = 0; i < 16; ++i) {
            const int along = static_cast<int>(random() % 40);
            for (int c = 0; c < 3; ++c) rgba[4 * i + c] = static_cast<uint8_t>(base + along * (c + 1) / 3);
            rgba[4 * i + 3] = random() % 3 == 0 ? 0 : 255;
        }
        const Shown shown = round_trip(rgba);
        for (int i = 0; i < 16; ++i) {
            if (rgba[4 * i + 3] == 0) continue;
            for (int c = 0; c < 3; ++c) {
                const double difference = shown.rgba[i][c] - rgba[4 * i + c];
                sum += difference * difference;
            }
        }
    }
    const double mean = sum / (2000 * 16 * 3 * 2.0 / 3.0);
    std::printf("mean squared error of a channel: %.2f\n", mean);
    // Three colours over ranges of 13, 27 and 40: a uniform spread leaves (range / 4)^2 / 3 * ..., about 19; and the
    // grid.
    EXPECT_LT(mean, 22.0);
}

TEST(Bc1Cutout, BytesOfAKnownBlock) {
    uint8_t rgba[64];
    for (int i = 0; i < 16; ++i) {
        const uint8_t texel[4] = {static_cast<uint8_t>(i < 8 ? 255 : 0), 0, static_cast<uint8_t>(i < 8 ? 0 : 255),
                                  static_cast<uint8_t>(i % 4 == 3 ? 0 : 255)};
        std::copy_n(texel, 4, rgba + 4 * i);
    }
    uint32_t block[2];
    encode_bc1_cutout_block(rgba, {}, block);
    EXPECT_EQ(block[0], 0xf800001fu) << std::hex << block[0];
    EXPECT_EQ(block[1], 0xc0c0d5d5u) << std::hex << block[1];
}

}  // namespace
}  // namespace citystream::codec::atlas
