#include "codec/bits/range_coder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/hexadecimal.h"

namespace citystream::codec::bits {
namespace {

std::vector<std::byte> exact_prefix(const std::vector<std::byte>& bytes, size_t size) {
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// A message of everything the coder has, from one seed: written with an encoder, read with a decoder.
template <typename Coder>
std::vector<uint32_t> code_mixture(Coder& coder, uint32_t seed, int count) {
    std::mt19937 random(seed);
    std::vector<uint32_t> values;
    std::vector<BitModel> models(4, BitModel(0.1, 10));
    BitTree tree(11), single(1);
    NumberModel numbers;
    for (int i = 0; i < count; ++i) {
        const auto a = static_cast<uint32_t>(random()), b = static_cast<uint32_t>(random());
        values.push_back(coder.bit(models[a % 4], b % 8 == 0 ? 1 : 0));
        values.push_back(coder.uniform(1 + a % 65536, b % (1 + a % 65536)));
        values.push_back(coder.plain_bits(a % 33, b & static_cast<uint32_t>((uint64_t{1} << a % 33) - 1)));
        values.push_back(tree.code(coder, b % 11));
        values.push_back(single.code(coder, 0));
        values.push_back(numbers.code(coder, b >> a % 32));
    }
    return values;
}

TEST(RangeCoder, GivesBackEveryKindOfNumber) {
    for (uint32_t seed = 0; seed < 40; ++seed) {
        RangeEncoder encoder;
        const auto written = code_mixture(encoder, seed, 1 << seed % 10);
        const auto bytes = encoder.finish();
        RangeDecoder decoder(bytes);
        ASSERT_EQ(code_mixture(decoder, seed, 1 << seed % 10), written) << seed;
        EXPECT_TRUE(decoder.finish().ok()) << seed;
    }
}

TEST(RangeCoder, NumbersAtTheEndsOfTheirRangeComeBack) {
    RangeEncoder encoder;
    const uint32_t numbers[] = {0, 1, 0xfffffffeu, 0xffffffffu, 0x7fffffffu, 0x80000000u};
    NumberModel writing, reading;
    for (const uint32_t number : numbers) writing.code(encoder, number);
    const auto bytes = encoder.finish();
    RangeDecoder decoder(bytes);
    for (const uint32_t number : numbers) EXPECT_EQ(reading.code(decoder), number);
    for (const int32_t value : {0, -1, 1, INT32_MIN, INT32_MAX, -77}) EXPECT_EQ(unzigzag(zigzag(value)), value);
    EXPECT_EQ(zigzag(-1), 1u);
    EXPECT_EQ(zigzag(2), 4u);
}

TEST(RangeCoder, CarryRunsThroughBytesOfOnes) {
    // A bit of the tiniest probability at the top of the interval after many sure ones at the top: long runs of 0xff.
    for (int length = 1; length < 60; ++length) {
        RangeEncoder encoder;
        for (int i = 0; i < length; ++i) encoder.uniform(256, 255);
        encoder.uniform(3, 2);
        encoder.uniform(65536, 65535);
        const auto bytes = encoder.finish();
        RangeDecoder decoder(bytes);
        for (int i = 0; i < length; ++i) ASSERT_EQ(decoder.uniform(256), 255u);
        EXPECT_EQ(decoder.uniform(3), 2u);
        EXPECT_EQ(decoder.uniform(65536), 65535u);
        EXPECT_TRUE(decoder.finish().ok());
    }
}

TEST(RangeCoder, NothingTakesNoBytesAndOneLikelyBitTakesNone) {
    RangeEncoder encoder;
    EXPECT_TRUE(encoder.finish().empty());
    BitModel model;
    encoder.bit(model, 1);
    EXPECT_LE(encoder.finish().size(), 1u);
    EXPECT_TRUE(encoder.finish().empty()) << "finish starts anew";
    const RangeDecoder nothing({});
    EXPECT_TRUE(nothing.finish().ok());
}

TEST(RangeCoder, SkewedSourcesComeNearTheirEntropy) {
    for (const double p : {0.5, 0.1, 0.01, 0.001}) {
        std::mt19937 random(3);
        std::bernoulli_distribution source(p);
        RangeEncoder encoder;
        BitModel model;
        const int count = 100000;
        for (int i = 0; i < count; ++i) encoder.bit(model, source(random) ? 1 : 0);
        const double entropy = count * (-p * std::log2(p) - (1 - p) * std::log2(1 - p)) / 8;
        const auto size = static_cast<double>(encoder.finish().size());
        EXPECT_LT(size, entropy * 1.06 + 20) << p;
        EXPECT_GT(size, entropy * 0.9) << p;
    }
}

TEST(RangeCoder, UniformNumbersCostTheirLogarithmAndTheEndLessThanAByte) {
    std::mt19937 random(5);
    double bits = 0;
    RangeEncoder encoder;
    for (int i = 0; i < 3000; ++i) {
        const auto count = static_cast<uint32_t>(1 + random() % 1000);
        encoder.uniform(count, static_cast<uint32_t>(random() % count));
        bits += std::log2(count);
        if (i % 10 != 9) continue;
        EXPECT_LE(static_cast<double>(encoder.finish().size()), bits / 8 + 1.05) << i;
        bits = 0;
    }
}

TEST(RangeCoder, AModelLearnsAFirstGuessAndChanges) {
    BitModel sure(0.99, BitModel::kMostWeight), half;
    EXPECT_NEAR(sure.probability_of_one(), 0.99 * 65536, 2);
    EXPECT_EQ(half.probability_of_one(), 32768u);
    EXPECT_NEAR(half.cost(1), 1, 1e-6);
    for (int i = 0; i < 4; ++i) half.learn(0);
    EXPECT_LT(half.probability_of_one(), 65536u / 8);
    for (int i = 0; i < 100000; ++i) half.learn(0);
    EXPECT_GE(half.probability_of_one(), 1u);
    EXPECT_LT(half.cost(0), 1e-4);
    for (int i = 0; i < 100; ++i) half.learn(1);
    EXPECT_GT(half.probability_of_one(), 65536u / 2);
}

TEST(RangeCoder, EveryTruncationEndsWithOtherNumbers) {
    RangeEncoder encoder;
    const auto written = code_mixture(encoder, 9, 20);
    const auto bytes = encoder.finish();
    for (size_t size = 0; size < bytes.size(); ++size) {
        const auto prefix = exact_prefix(bytes, size);
        RangeDecoder decoder(prefix);
        const auto read = code_mixture(decoder, 9, 20);
        ASSERT_EQ(read.size(), written.size());
        EXPECT_NE(read, written) << size;
        EXPECT_LE(decoder.position(), size);
    }
}

TEST(RangeCoder, PastThePaddingReadingIsAnErrorThatStays) {
    RangeEncoder encoder;
    for (uint32_t i = 0; i < 100; ++i) encoder.plain_bits(8, i + 1);
    const auto bytes = encoder.finish();
    ASSERT_LE(bytes.size(), 101u);
    for (size_t size = 0; size + 1 < bytes.size(); ++size) {
        const auto prefix = exact_prefix(bytes, size);
        RangeDecoder decoder(prefix);
        for (uint32_t i = 0; i < 100; ++i) decoder.plain_bits(8);
        if (size + RangeDecoder::kPaddingBytes + 1 < bytes.size()) {
            ASSERT_FALSE(decoder.ok()) << size;
            EXPECT_EQ(decoder.plain_bits(32), 0u) << "zeros after the error";
        }
        ASSERT_FALSE(decoder.finish().ok() && size + 1 < bytes.size()) << size;
        EXPECT_EQ(decoder.finish().error().offset, size);
    }
}

TEST(RangeCoder, BytesThatFollowAreAnError) {
    for (uint32_t seed = 0; seed < 50; ++seed) {
        RangeEncoder encoder;
        code_mixture(encoder, seed, 3);
        auto bytes = encoder.finish();
        for (int extra = 0; extra < 2; ++extra) bytes.push_back(std::byte{0});
        RangeDecoder decoder(bytes);
        code_mixture(decoder, seed, 3);
        EXPECT_FALSE(decoder.finish().ok()) << seed;
    }
}

TEST(RangeCoder, AnyBytesAreReadToSomeNumbers) {
    std::mt19937 random(11);
    for (int i = 0; i < 300; ++i) {
        std::vector<std::byte> bytes(random() % 200);
        for (auto& byte : bytes) byte = i % 3 == 0 ? std::byte{0xff} : static_cast<std::byte>(random());
        RangeDecoder decoder(bytes);
        const auto values = code_mixture(decoder, static_cast<uint32_t>(i), 50);
        for (size_t k = 3; k < values.size(); k += 6) EXPECT_LT(values[k], 11u);
    }
}

TEST(RangeCoder, GoldenBytes) {
    RangeEncoder encoder;
    BitModel model;
    for (const uint32_t bit : {0u, 0u, 0u, 1u, 0u, 0u}) encoder.bit(model, bit);
    BitTree tree(5);
    for (const uint32_t value : {4u, 4u, 0u, 2u}) tree.code(encoder, value);
    NumberModel numbers;
    for (const uint32_t value : {0u, 3u, 100u, 70000u}) numbers.code(encoder, value);
    encoder.uniform(10, 7);
    encoder.plain_bits(20, 0xabcde);
    EXPECT_EQ(test::hexadecimal(encoder.finish()), "a49c9f76f4c3b84ab4d9002b");
}

}  // namespace
}  // namespace citystream::codec::bits
