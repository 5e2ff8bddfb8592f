#include "codec/atlas/bc4.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

namespace citystream::codec::atlas {
namespace {

int square_error(const uint8_t values[16]) {
    uint32_t block[2];
    encode_bc4_block(values, block);
    int sum = 0;
    for (uint32_t i = 0; i < 16; ++i) {
        const int difference = decode_bc4_texel(block, i) - values[i];
        sum += difference * difference;
    }
    return sum;
}

TEST(Bc4, DecoderFollowsTheIntegersOfTheFormat) {
    uint64_t bits = 200 | 60 << 8;
    for (uint64_t i = 0; i < 16; ++i) bits |= i % 8 << (16 + 3 * i);
    const uint32_t eight[2] = {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32)};
    const uint8_t of_eight[8] = {200, 60, 180, 160, 140, 120, 100, 80};
    bits = (bits & ~uint64_t{0xffff}) | 60 | 200 << 8;
    const uint32_t six[2] = {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32)};
    const uint8_t of_six[8] = {60, 200, 88, 116, 144, 172, 0, 255};
    for (uint32_t i = 0; i < 16; ++i) {
        EXPECT_EQ(decode_bc4_texel(eight, i), of_eight[i % 8]) << i;
        EXPECT_EQ(decode_bc4_texel(six, i), of_six[i % 8]) << i;
    }
}

TEST(Bc4, OneOrTwoValuesAreExactAndSoAreZeroAndFullBesideThem) {
    std::mt19937 random(1);
    for (int round = 0; round < 4000; ++round) {
        const uint8_t kept[4] = {static_cast<uint8_t>(random()), static_cast<uint8_t>(random()), 0, 255};
        uint8_t values[16];
        for (uint8_t& value : values) value = kept[random() % static_cast<unsigned>(round % 4 + 1)];
        ASSERT_EQ(square_error(values), 0) << round;
    }
}

TEST(Bc4, RampsAndNoiseStayWithinHalfAStepOfTheirRange) {
    std::mt19937 random(2);
    for (int round = 0; round < 4000; ++round) {
        const int low = static_cast<int>(random() % 256),
                  span = static_cast<int>(random() % static_cast<unsigned>(256 - low));
        uint8_t values[16];
        for (uint8_t& value : values)
            value = static_cast<uint8_t>(low + static_cast<int>(random() % static_cast<unsigned>(span + 1)));
        // Eight values over the range: no texel further than a fourteenth of it, and rounding.
        const double worst = span / 14.0 + 1;
        ASSERT_LE(square_error(values), 16 * worst * worst) << round;
    }
}

TEST(Bc4, FitsNoiseNearlyAsWellAsTheBestOfAllEnds) {
    std::mt19937 random(3);
    long ours = 0, least = 0;
    for (int round = 0; round < 12; ++round) {
        uint8_t values[16];
        const auto low = static_cast<uint32_t>(random() % 200), span = static_cast<uint32_t>(1 + random() % 55);
        for (uint8_t& value : values) value = static_cast<uint8_t>(low + random() % span);
        ours += square_error(values);
        int best = 1 << 30;
        for (uint32_t ends = 0; ends < 65536; ++ends) {
            uint64_t bits = ends;
            for (uint32_t i = 0; i < 8; ++i) bits |= uint64_t{i} << (16 + 3 * i);
            const uint32_t block[2] = {static_cast<uint32_t>(bits), static_cast<uint32_t>(bits >> 32)};
            int palette[8];
            for (uint32_t i = 0; i < 8; ++i) palette[i] = decode_bc4_texel(block, i);
            int sum = 0;
            for (const uint8_t value : values) {
                int nearest = 1 << 30;
                for (const int colour : palette) nearest = std::min(nearest, (colour - value) * (colour - value));
                sum += nearest;
            }
            best = std::min(best, sum);
        }
        least += best;
    }
    std::printf("squared error: ours %ld, least %ld\n", ours, least);
    EXPECT_LE(ours, least * 115 / 100 + 12);
}

TEST(Bc4, BytesOfAKnownBlock) {
    const uint8_t values[16] = {0, 17, 34, 51, 68, 85, 102, 119, 136, 153, 170, 187, 204, 221, 238, 255};
    uint32_t block[2];
    encode_bc4_block(values, block);
    EXPECT_EQ(block[0], 0x6fc908f7u) << std::hex << block[0];
    EXPECT_EQ(block[1], 0x0126e4b7u) << std::hex << block[1];
}

}  // namespace
}  // namespace citystream::codec::atlas
