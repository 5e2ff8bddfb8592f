#include "codec/bits/bit_stream.h"

#include <gtest/gtest.h>

#include <random>

namespace citystream::codec::bits {
namespace {

TEST(BitStream, BitsForIsTheWidthOfTheLargestValue) {
    EXPECT_EQ(bits_for(0), 0u);
    EXPECT_EQ(bits_for(1), 1u);
    EXPECT_EQ(bits_for(255), 8u);
    EXPECT_EQ(bits_for(256), 9u);
    EXPECT_EQ(bits_for(0xffffffffu), 32u);
}

TEST(BitStream, WordsForRoundsUpAndDoesNotOverflow) {
    EXPECT_EQ(words_for(0, 32), 0u);
    EXPECT_EQ(words_for(7, 0), 0u);
    EXPECT_EQ(words_for(1, 1), 1u);
    EXPECT_EQ(words_for(32, 1), 1u);
    EXPECT_EQ(words_for(33, 1), 2u);
    EXPECT_EQ(words_for(3, 11), 2u);
    EXPECT_EQ(words_for(uint64_t{1} << 62, 32), uint64_t{1} << 62);
    EXPECT_GT(words_for(uint64_t{3} * 0xffffffffu, 32), uint64_t{0xffffffffu});
}

TEST(BitStream, PacksLeastSignificantBitFirst) {
    BitWriter writer;
    writer.put(0b101, 3);
    writer.put(0xffffffffu, 0);
    writer.put(0x12345678u, 32);
    writer.put(0xffffu, 4);
    EXPECT_EQ(writer.finish(), (std::vector<uint32_t>{0x91a2b3c5u, 0x78u}));
    EXPECT_TRUE(writer.finish().empty()) << "finish starts anew";
}

TEST(BitStream, ReadsBackMixedWidthsAcrossWordBorders) {
    std::mt19937 random(1);
    std::vector<std::pair<uint32_t, uint32_t>> fields;
    BitWriter writer;
    for (int i = 0; i < 5000; ++i) {
        const auto width = static_cast<uint32_t>(random() % 33);
        const uint32_t value = width == 0 ? 0 : static_cast<uint32_t>(random()) >> (32 - width);
        fields.emplace_back(value, width);
        writer.put(value, width);
    }
    const std::vector<uint32_t> words = writer.finish();
    uint64_t bit = 0;
    for (const auto& [value, width] : fields) {
        ASSERT_EQ(read_bits(words, bit, width), value) << "at bit " << bit;
        bit += width;
    }
    EXPECT_EQ(words.size(), (bit + 31) / 32);
}

TEST(BitStream, FieldThatEndsTheLastWordIsReadWithoutTouchingTheNext) {
    const std::vector<uint32_t> words = {0xdeadbeefu};
    EXPECT_EQ(read_bits(words, 0, 32), 0xdeadbeefu);
    EXPECT_EQ(read_bits(words, 31, 1), 1u);
    EXPECT_EQ(read_bits(words, 32, 0), 0u);
}

}  // namespace
}  // namespace citystream::codec::bits
