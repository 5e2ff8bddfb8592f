// The binary factor form: bytes, terms and what its reader refuses beyond its sizes.
#include "codec/facade/binary_map.h"

#include <gtest/gtest.h>

#include <bit>
#include <chrono>

#include "codec/facade/binary_layout.h"
#include "codec/facade/facade_form_layout.h"
#include "codec/facade/raw_map.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

/// A wall 32 x 24 with two stripes over its whole height: few bits to look at.
RunGrid striped_grid() {
    FacadeMatrices relief = uniform_relief(32, 24, -10, 2);
    fill_rectangle(relief, 8, 12, 0, 24, 30, 2);
    fill_rectangle(relief, 20, 24, 0, 24, 30, 2);
    return make_run_grid(relief).value();
}

TEST(BinaryMap, HasTheBytesOfItsVersion) {
    // The walls left, between and right of the stripes have a box each; the stripes the whole facade, the second box.
    const std::vector<uint32_t> head = {
        0x00074643, 0x00180020, 0x001efff6, 1,  // binary, 32 x 24, -10..30 mm, shared rows
        32,         33,         35,         1,  // D: X, Y, sigma, words a row
        0xfffffff6, 36,         48,         1,  // over a base of -10; indices; one term
        64,         64,         64,         0,  // M
        2,          0,          0,          0,  // no term
        64,         65,         69,         1,  // A
        3,          72,         84,         3,  // three terms
        100,        4,          0,          0,  // boxes
    };
    const std::vector<uint32_t> displacement = {
        1,                    // X has one row
        0,          1,        // Y two
        40,                   // sigma
        0,          0, 0, 0,  // row 0 of X for all texel rows
        0,          0, 0, 0,  //
        0,          0, 0, 0,  //
        0,          0, 0, 0,  // Y: texel columns 0..7,
        0x00010001,           // 8, 9
        0x00010001,           // 10, 11
        0,          0, 0, 0,  // 12..19
        0x00010001,           // 20, 21
        0x00010001,           // 22, 23
        0,          0, 0, 0,  // 24..31
    };
    const std::vector<uint32_t> boxes = {0x00080000, 0x00180000, 0x00200000, 0x00180000,
                                         0x0014000c, 0x00180000, 0x00200018, 0x00180000};
    const std::vector<uint32_t> words = encode_binary_map(striped_grid(), BinaryVariant::kShared).value();
    ASSERT_EQ(words.size(), 108u);
    EXPECT_EQ(std::vector<uint32_t>(words.begin(), words.begin() + 32), head);
    EXPECT_EQ(std::vector<uint32_t>(words.begin() + 32, words.begin() + 64), displacement);
    EXPECT_EQ(std::vector<uint32_t>(words.begin() + 100, words.end()), boxes);
    EXPECT_EQ(decode_binary_map(words).value(), striped_grid());
}

TEST(BinaryMap, OfFigure8HasOneTermForDepthAndMaterial) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();
    for (const BinaryVariant variant : {BinaryVariant::kPaper, BinaryVariant::kShared}) {
        const FactorTerms terms = binary_terms(encode_binary_map(grid, variant).value());
        EXPECT_EQ(terms.displacement, 1u);
        EXPECT_EQ(terms.material, 1u);
    }
}

TEST(BinaryMap, HasAtMostOneCommonBitInRowAndColumn) {
    const std::vector<uint32_t> words =
        encode_binary_map(make_run_grid(window_relief(400, 500, 5, true)).value()).value();
    const uint32_t width = words[FACADE_FORM_WORD_SIZE] & 0xffffu, height = words[FACADE_FORM_WORD_SIZE] >> 16;
    for (const uint32_t map :
         {FACADE_BINARY_WORD_DISPLACEMENT, FACADE_BINARY_WORD_MATERIAL, FACADE_BINARY_WORD_BOX_INDEX}) {
        const uint32_t x = words[map + FACADE_BINARY_MAP_X], y = words[map + FACADE_BINARY_MAP_Y];
        const uint32_t row_words = words[map + FACADE_BINARY_MAP_ROW_WORDS];
        EXPECT_GT(row_words, 1u);  // terms beyond bit 31
        for (uint32_t i = 0; i < height; ++i) {
            for (uint32_t j = 0; j < width; ++j) {
                int common = 0;
                for (uint32_t w = 0; w < row_words; ++w)
                    common += std::popcount(words[x + i * row_words + w] & words[y + j * row_words + w]);
                ASSERT_LE(common, 1);
            }
        }
    }
}

TEST(BinaryMap, OfManyTermsIsExactInEveryBit) {
    // More than 64 values in stripes: every bit of a word, bit 31 too, is the only one of some entry.
    FacadeMatrices relief = uniform_relief(300, 300, 0, 1);
    for (uint32_t i = 0; i < 75; ++i) fill_rectangle(relief, 4 * i, 4 * i + 4, 0, 300, static_cast<int32_t>(i * 11), 1);
    const RunGrid grid = make_run_grid(relief).value();
    const std::vector<uint32_t> words = encode_binary_map(grid).value();
    EXPECT_EQ(binary_terms(words).displacement, 74u);
    for (uint32_t x = 0; x < 300; ++x) EXPECT_EQ(displacement_of(binary_label(words, x, 299 - x)), int(x / 4 * 11));
}

TEST(BinaryMap, OfAMillionTexelsTakesNoSeconds) {
    const RunGrid grid = make_run_grid(window_relief(1366, 1024, 3, false)).value();
    const auto begin = std::chrono::steady_clock::now();
    const auto words = encode_binary_map(grid);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
    ASSERT_TRUE(words.ok()) << words.error().text();
    EXPECT_GT(binary_terms(*words).box_index, 1800u);
    EXPECT_EQ(decode_binary_map(*words).value(), grid);
}

TEST(BinaryMap, SharedIsSmaller) {
    const RunGrid grid = make_run_grid(window_relief(400, 500, 5, false)).value();
    EXPECT_LT(encode_binary_map(grid, BinaryVariant::kShared)->size(), encode_binary_map(grid)->size() / 2);
}

TEST(BinaryMap, RefusesTermsThatOverlap) {
    std::vector<uint32_t> words = encode_binary_map(make_run_grid(window_relief(400, 500, 5, false)).value()).value();
    const uint32_t x = words[FACADE_BINARY_WORD_DISPLACEMENT + FACADE_BINARY_MAP_X];
    const uint32_t sigma = words[FACADE_BINARY_WORD_DISPLACEMENT + FACADE_BINARY_MAP_SIGMA];
    for (uint32_t word = x; word < sigma; ++word) words[word] |= 3;  // the first two terms cover everything
    EXPECT_TRUE(check_binary_map(words).ok());                       // no lookup leaves the words
    EXPECT_FALSE(decode_binary_map(words).ok());
}

TEST(BinaryMap, RefusesBitsOfAbsentTerms) {
    std::vector<uint32_t> words = encode_binary_map(make_run_grid(figure8_relief()).value()).value();
    words[words[FACADE_BINARY_WORD_DISPLACEMENT + FACADE_BINARY_MAP_X]] |= 2;
    EXPECT_FALSE(check_binary_map(words).ok());
}

}  // namespace
}  // namespace citystream::codec::facade
