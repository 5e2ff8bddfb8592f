// Bits under mixed contexts: both directions agree, contexts that know are believed, and those that do not cost little.
#include "codec/bits/mixed_bits.h"

#include <gtest/gtest.h>

#include <random>

namespace citystream::codec::bits {
namespace {

struct Sample {
    uint32_t bit, knows, noise;
};

std::vector<Sample> samples(uint32_t seed, double reliable) {
    std::mt19937 random(seed);
    std::vector<Sample> result;
    for (int i = 0; i < 20000; ++i) {
        const uint32_t bit = random() & 1;
        const bool right = static_cast<double>(random()) < reliable * 4294967296.0;
        result.push_back({bit, right ? bit : 1 - bit, static_cast<uint32_t>(random() % 64)});
    }
    return result;
}

size_t bytes_with(const std::vector<Sample>& list, bool knowing) {
    RangeEncoder encoder;
    MixedBits bits({2, 64, 64}, 1);
    for (const Sample& s : list) {
        bits.set_contexts({knowing ? s.knows : 0, s.noise, 63 - s.noise});
        bits.code(encoder, 0, s.bit);
    }
    return encoder.finish().size();
}

TEST(MixedBits, ReadsWhatItWrote) {
    const auto list = samples(1, 0.9);
    RangeEncoder encoder;
    MixedBits writer({2, 64}, 3, 2);
    for (const Sample& s : list) {
        writer.set_contexts({s.knows, s.noise}, s.noise & 1);
        writer.code(encoder, s.noise % 3, s.bit);
    }
    const auto bytes = encoder.finish();
    RangeDecoder decoder(bytes);
    MixedBits reader({2, 64}, 3, 2);
    for (const Sample& s : list) {
        reader.set_contexts({s.knows, s.noise}, s.noise & 1);
        ASSERT_EQ(reader.code(decoder, s.noise % 3), s.bit);
    }
    EXPECT_TRUE(decoder.finish().ok());
}

TEST(MixedBits, BelievesTheContextThatKnows) {
    // 20,000 bits of which one in a hundred is a surprise: 202 bytes by their entropy.
    EXPECT_LT(bytes_with(samples(2, 0.99), true), 290u);
}

TEST(MixedBits, PaysNextToNothingForContextsThatSayNothing) {
    // 2,500 bytes is what equally likely bits take.
    EXPECT_LT(bytes_with(samples(3, 0.5), false), 2580u);
}

TEST(MixedBits, TakesAContextPastItsCountAsTheLast) {
    RangeEncoder encoder;
    MixedBits bits({4}, 1);
    bits.set_contexts({~0u});
    EXPECT_EQ(bits.code(encoder, 0, 1), 1u);
}

TEST(MixedBits, IsAsItWasMadeForContextsThatWereNotMet) {
    // Of two that have the same bits in the same context, one has met a thousand other contexts before.
    RangeEncoder few, many;
    MixedBits fresh({1000}, 2), worn({1000}, 2, 2);
    for (uint32_t value = 1; value < 1000; ++value) {
        worn.set_contexts({value}, 1);
        worn.code(many, value % 2, 1);
    }
    const double before = many.cost();
    fresh.set_contexts({0});
    worn.set_contexts({0});
    for (uint32_t i = 0; i < 50; ++i) {
        fresh.code(few, i % 2, i % 3 == 0 ? 1 : 0);
        worn.code(many, i % 2, i % 3 == 0 ? 1 : 0);
    }
    const double start = RangeEncoder().cost();
    EXPECT_NEAR(many.cost() - before, few.cost() - start, 0.01);
}

template <typename Numbers>
void expect_every_length_again() {
    std::vector<uint32_t> numbers = {0, 1, 2, 0xfffffffe, 0xffffffff};
    for (uint32_t bit = 0; bit < 32; ++bit) numbers.insert(numbers.end(), {1u << bit, (1u << bit) - 1, 3u << bit});
    RangeEncoder encoder;
    Numbers writer({3});
    for (size_t i = 0; i < numbers.size(); ++i) {
        writer.set_contexts({static_cast<uint32_t>(i % 3)});
        writer.code(encoder, numbers[i]);
    }
    const auto bytes = encoder.finish();
    RangeDecoder decoder(bytes);
    Numbers reader({3});
    for (size_t i = 0; i < numbers.size(); ++i) {
        reader.set_contexts({static_cast<uint32_t>(i % 3)});
        ASSERT_EQ(reader.code(decoder), numbers[i]);
    }
    EXPECT_TRUE(decoder.finish().ok());
}

TEST(MixedNumbers, ReadsEveryLengthOfNumberAgain) {
    expect_every_length_again<MixedNumbers>();
    expect_every_length_again<MixedLengthNumbers<1>>();
    expect_every_length_again<MixedLengthNumbers<2>>();
    expect_every_length_again<MixedLengthNumbers<5>>();
}

template <typename Numbers>
void expect_end_of_bytes() {
    RangeDecoder decoder({});
    Numbers reader({1});
    reader.set_contexts({0});
    for (int i = 0; i < 100000; ++i) reader.code(decoder);
    EXPECT_FALSE(decoder.ok());
}

TEST(MixedNumbers, EndsOnBytesThatRunOut) {
    expect_end_of_bytes<MixedNumbers>();
    expect_end_of_bytes<MixedLengthNumbers<2>>();
}

}  // namespace
}  // namespace citystream::codec::bits
