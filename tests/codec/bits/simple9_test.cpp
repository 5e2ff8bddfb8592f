#include "codec/bits/simple9.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace citystream::codec::bits {
namespace {

/// The paper's choice: the first selector whose codes all fit.
size_t greedy_words(const std::vector<uint32_t>& values) {
    size_t words = 0;
    for (size_t i = 0; i < values.size(); ++words) {
        for (uint32_t selector = 0; selector < kSimple9Selectors; ++selector) {
            const size_t end = std::min(values.size(), i + kSimple9Counts[selector]);
            const bool fits = std::all_of(values.begin() + static_cast<std::ptrdiff_t>(i),
                                          values.begin() + static_cast<std::ptrdiff_t>(end),
                                          [&](uint32_t value) { return value >> kSimple9Widths[selector] == 0; });
            if (!fits) continue;
            i = end;
            break;
        }
    }
    return words;
}

std::vector<uint32_t> random_values(size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<uint32_t> values(count);
    // Widths of 0..7 bits, now and then 28: what differences look like.
    for (uint32_t& value : values)
        value = static_cast<uint32_t>(random()) >> (random() % 40 == 0 ? 4 : 25 + random() % 8 % 7);
    return values;
}

TEST(Simple9, EveryCountAndEveryWidthComesBack) {
    for (uint32_t bits = 0; bits <= 28; ++bits) {
        for (size_t count = 0; count <= 60; ++count) {
            const std::vector<uint32_t> values(count, bits == 0 ? 0 : (uint32_t{1} << (bits - 1)));
            const auto words = pack_simple9(values);
            ASSERT_TRUE(words.has_value());
            EXPECT_TRUE(check_simple9(*words, count).ok()) << bits << " bits, " << count << " values";
            EXPECT_EQ(unpack_simple9(*words, count), values);
        }
    }
}

TEST(Simple9, RandomValuesComeBackAndTakeAtMostTheWordsOfTheGreedyChoice) {
    size_t words_taken = 0, greedily = 0;
    for (uint32_t seed = 0; seed < 50; ++seed) {
        const auto values = random_values(1000, seed);
        const auto words = pack_simple9(values).value();
        EXPECT_EQ(unpack_simple9(words, values.size()), values);
        EXPECT_LE(words.size(), greedy_words(values));
        words_taken += words.size();
        greedily += greedy_words(values);
    }
    EXPECT_LT(words_taken, greedily) << "the shortest path is the greedy choice";
}

TEST(Simple9, GreatestValueFitsAndTheNextDoesNot) {
    EXPECT_EQ(unpack_simple9(pack_simple9(std::vector{kSimple9Most}).value(), 1), std::vector{kSimple9Most});
    EXPECT_FALSE(pack_simple9(std::vector<uint32_t>{1, kSimple9Most + 1}).has_value());
}

TEST(Simple9, WordsAreLaidOutAsWritten) {
    // Five codes of 5 bits, selector 4; then two of 14, selector 7.
    const std::vector<uint32_t> values = {31, 0, 17, 16, 30, 10000, 9000};
    const std::vector<uint32_t> expected = {4u | 31u << 4 | 17u << 14 | 16u << 19 | 30u << 24,
                                            7u | 10000u << 4 | 9000u << 18};
    EXPECT_EQ(pack_simple9(values).value(), expected);
}

TEST(Simple9, WordsThatNobodyWritesAreRefused) {
    const auto words = pack_simple9(random_values(100, 7)).value();
    EXPECT_TRUE(check_simple9(words, 100).ok());
    EXPECT_FALSE(check_simple9(std::span(words).first(words.size() - 1), 100).ok()) << "a word is missing";
    auto longer = words;
    longer.push_back(0);
    EXPECT_FALSE(check_simple9(longer, 100).ok()) << "a word too many";
    for (uint32_t selector = 9; selector < 16; ++selector) {
        auto damaged = words;
        damaged[3] = (damaged[3] & ~15u) | selector;
        EXPECT_FALSE(check_simple9(damaged, 100).ok()) << "selector " << selector;
    }
    EXPECT_TRUE(check_simple9(std::vector<uint32_t>{0u | 1u << 4}, 1).ok());
    EXPECT_FALSE(check_simple9(std::vector<uint32_t>{0u | 2u << 4}, 1).ok()) << "padding of the last word";
    EXPECT_TRUE(check_simple9({}, 0).ok());
    EXPECT_FALSE(check_simple9(std::vector<uint32_t>{0u}, 0).ok());
    EXPECT_FALSE(check_simple9({}, uint64_t{1} << 40).ok());
}

}  // namespace
}  // namespace citystream::codec::bits
