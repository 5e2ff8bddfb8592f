#include "codec/mesh/adaptive_precision.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/codec/damage.h"

namespace citystream::codec::mesh {
namespace {

PrecisionShape plain_shape(uint32_t vertices, uint32_t full_bits, uint32_t components = 3) {
    PrecisionShape shape;
    shape.vertices = vertices;
    shape.components = components;
    shape.full_bits = full_bits;
    return shape;
}

std::vector<uint32_t> random_words(const PrecisionShape& shape, uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<uint32_t> words;
    for (uint32_t i = 0; i < shape.vertices * shape.components; ++i) {
        const uint32_t bits = shape.full_bits - shape.leading[i % shape.components];
        words.push_back(static_cast<uint32_t>(random() & ((uint64_t{1} << bits) - 1)));
    }
    return words;
}

std::vector<uint32_t> planes(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t from, uint32_t to) {
    std::vector<uint32_t> all;
    for (uint32_t plane = from; plane < to; ++plane) {
        const auto one = precision_plane(shape, words, plane);
        EXPECT_EQ(one.size(), shape.plane_words(plane));
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

std::vector<uint32_t> changed(std::span<const uint32_t> buffer, uint32_t to, std::span<const uint32_t> added) {
    const auto view = PrecisionView::create(buffer);
    EXPECT_TRUE(view.ok());
    const auto result = change_level(*view, to, added);
    EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
    return result.ok() ? *result : std::vector<uint32_t>{};
}

PrecisionShape binned_shape() {
    PrecisionShape shape = plain_shape(211, 17);
    shape.leading = {0, 1, 6, 0};
    shape.bins = {{0, 1}, {90, 5}, {100, 6}, {180, 17}};
    return shape;
}

TEST(AdaptivePrecision, PayloadIsThreeTimesTheLevelBitsAVertexAndNothingElse) {
    for (uint32_t level = 1; level <= 25; ++level) {
        for (const uint32_t vertices : {1u, 31u, 32u, 1000u}) {
            const PrecisionShape shape = plain_shape(vertices, 25);
            const auto buffer = pack_precision(shape, random_words(shape, level), level);
            EXPECT_EQ((buffer.size() - shape.header_words()) * 4, (3 * level * vertices + 31) / 32 * 4);
        }
    }
    // Ten bits are 31.25 % of three floats.
    const PrecisionShape shape = plain_shape(3200, 25);
    EXPECT_EQ((shape.words_at(10) - shape.header_words()) * 4 * 10000, uint64_t{3200} * 12 * 3125);
}

TEST(AdaptivePrecision, FetchGivesTheTopBitsOfEveryWord) {
    for (const uint32_t full : {1u, 2u, 16u, 25u, 31u}) {
        const PrecisionShape shape = plain_shape(77, full, full % 4 + 1);
        const auto words = random_words(shape, full);
        for (uint32_t level = 0; level <= full; ++level) {
            const auto buffer = pack_precision(shape, words, level);
            const auto view = PrecisionView::create(buffer);
            ASSERT_TRUE(view.ok()) << view.error().text();
            for (uint32_t v = 77; v-- > 0;) {
                uint32_t out[4] = {};
                ASSERT_EQ(view->fetch(v, out), level);
                for (uint32_t c = 0; c < shape.components; ++c) {
                    const uint64_t kept = uint64_t{words[v * shape.components + c]} >> (full - level) << (full - level);
                    ASSERT_EQ(out[c], kept);
                }
            }
        }
    }
}

TEST(AdaptivePrecision, LevelWalkEqualsDirectPackingAndUploadsThreeBitsAVertexALevel) {
    const PrecisionShape shape = plain_shape(320, 16);
    const auto words = random_words(shape, 9);
    auto buffer = pack_precision(shape, words, 5);
    uint64_t uploaded = 0;
    const auto walk_to = [&](uint32_t level) {
        const uint32_t from = PrecisionView::create(buffer)->level();
        const auto added = planes(shape, words, from, level);
        uploaded += added.size() * 4;
        EXPECT_EQ(added.size(), shape.words_between(from, level));
        buffer = changed(buffer, level, added);
        EXPECT_EQ(buffer, pack_precision(shape, words, level)) << level;
    };
    for (uint32_t level = 6; level <= 12; ++level) walk_to(level);
    EXPECT_EQ(uploaded, 7u * 3 * 320 / 8);
    for (uint32_t level = 11; level >= 5; --level) walk_to(level);
    EXPECT_EQ(uploaded, 7u * 3 * 320 / 8);  // nothing downwards
    walk_to(12);
    EXPECT_EQ(uploaded, 14u * 3 * 320 / 8);
}

TEST(AdaptivePrecision, JumpsOfAnyLengthAreTheIdentityAfterAHundredChanges) {
    std::mt19937_64 random(10);
    const PrecisionShape shape = binned_shape();
    const auto words = random_words(shape, 11);
    auto buffer = pack_precision(shape, words, 8);
    uint32_t level = 8;
    for (int i = 0; i < 100; ++i) {
        const auto to = static_cast<uint32_t>(random() % (shape.full_bits + 1));
        buffer = changed(buffer, to, planes(shape, words, level, to));
        level = to;
        ASSERT_EQ(buffer, pack_precision(shape, words, level));
    }
}

TEST(AdaptivePrecision, BinsKeepTheirLeastLevelsAndLeadingZerosAreNotStored) {
    const PrecisionShape shape = binned_shape();
    ASSERT_TRUE(check_shape(shape).ok());
    const auto words = random_words(shape, 12);
    for (uint32_t level = 0; level <= 17; ++level) {
        const auto buffer = pack_precision(shape, words, level);
        ASSERT_EQ(buffer.size(), shape.words_at(level));
        const auto view = PrecisionView::create(buffer);
        ASSERT_TRUE(view.ok()) << view.error().text();
        uint64_t bits = 0;
        for (uint32_t v = 0; v < shape.vertices; ++v) {
            uint32_t out[3] = {};
            const uint32_t own = view->fetch(v, out);
            ASSERT_EQ(own, std::max(level, v < 90 ? 1u : v < 100 ? 5u : v < 180 ? 6u : 17u));
            for (uint32_t c = 0; c < 3; ++c) {
                ASSERT_EQ(out[c], words[3 * v + c] >> (17 - own) << (17 - own));
                bits += own - std::min(own, shape.leading[c]);
            }
        }
        EXPECT_EQ(bits, shape.payload_bits(level));
    }
}

TEST(AdaptivePrecision, BuffersWithoutVerticesAndOfOneVertexWork) {
    for (const uint32_t vertices : {0u, 1u}) {
        const PrecisionShape shape = plain_shape(vertices, 20);
        const auto words = random_words(shape, 1);
        const auto buffer = pack_precision(shape, words, 3);
        EXPECT_EQ(changed(buffer, 20, planes(shape, words, 3, 20)), pack_precision(shape, words, 20));
    }
}

TEST(AdaptivePrecision, ShapesThatOverflowAreRefused) {
    EXPECT_FALSE(check_shape(plain_shape(1u << 27, 1)).ok());
    EXPECT_FALSE(check_shape(plain_shape((1u << 27) - 1, 31, 4)).ok());  // 16.6 * 10^9 bits
    EXPECT_FALSE(check_shape(plain_shape(5, 32)).ok());
    EXPECT_FALSE(check_shape(plain_shape(5, 0)).ok());
    EXPECT_FALSE(check_shape(plain_shape(5, 10, 5)).ok());
    PrecisionShape shape = plain_shape(5, 10);
    shape.bins = {{0, 3}, {2, 3}};
    EXPECT_FALSE(check_shape(shape).ok());
    shape.bins = {{0, 3}, {5, 4}};
    EXPECT_FALSE(check_shape(shape).ok());
    shape.bins = {};
    EXPECT_FALSE(check_shape(shape).ok());
    shape.bins = {{0, 3}, {2, 11}};
    EXPECT_FALSE(check_shape(shape).ok());
}

TEST(AdaptivePrecision, PlanesOfTheWrongLengthAreRefused) {
    const PrecisionShape shape = plain_shape(100, 12);
    const auto words = random_words(shape, 13);
    const auto buffer = pack_precision(shape, words, 4);
    const auto view = PrecisionView::create(buffer);
    auto added = planes(shape, words, 4, 9);
    for (size_t length = 0; length < added.size(); ++length) {
        EXPECT_FALSE(change_level(*view, 9, exact_copy(std::span(added).first(length))).ok());
    }
    EXPECT_FALSE(change_level(*view, 3, added).ok());
    added.push_back(0);
    EXPECT_FALSE(change_level(*view, 9, added).ok());
    EXPECT_FALSE(change_level(*view, 13, added).ok());
}

TEST(AdaptivePrecision, DamagedBuffersAreRefusedOrReadWithoutLeavingThem) {
    const PrecisionShape shape = binned_shape();
    const auto buffer = pack_precision(shape, random_words(shape, 14), 3);
    for (size_t length = 0; length < buffer.size(); ++length) {
        EXPECT_FALSE(PrecisionView::create(exact_copy(std::span(buffer).first(length))).ok());
    }
    for_each_mutation(std::span(buffer).first(shape.header_words() + 3), [&](std::span<const uint32_t> head) {
        auto damaged = exact_copy(buffer);
        std::copy(head.begin(), head.end(), damaged.begin());
        const auto view = PrecisionView::create(damaged);
        if (!view.ok()) return;
        uint32_t out[4] = {};
        for (uint32_t v = 0; v < view->shape().vertices; ++v) view->fetch(v, out);
    });
}

}  // namespace
}  // namespace citystream::codec::mesh
