#include "codec/facade/quotient_map.h"

#include <gtest/gtest.h>

#include "codec/bits/bit_stream.h"
#include "codec/facade/quotient_layout.h"
#include "codec/facade/quotient_sections.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::codec::facade {
namespace {

std::vector<uint32_t> words_of(const FacadeMatrices& relief) {
    return encode_quotient_map(make_run_grid(relief).value()).value();
}

bool is_direct(const std::vector<uint32_t>& words) {
    return (words[QUOTIENT_WORD_CLASSES] >> QUOTIENT_DIRECT_BIT & 1) != 0;
}

bool is_dense(const std::vector<uint32_t>& words) {
    return (words[QUOTIENT_WORD_CLASSES] >> QUOTIENT_DENSE_BIT & 1) != 0;
}

TEST(QuotientMap, GivesTheCoarsestGridOfAFinerOne) {
    const RunGrid coarse = make_run_grid(figure8_relief()).value();
    RunGrid fine = coarse;
    fine.x_breaks.insert(fine.x_breaks.begin() + 1, 2);
    fine.labels.clear();
    for (uint32_t r = 0; r < coarse.rows(); ++r) {
        fine.labels.push_back(coarse.label(0, r));
        for (uint32_t c = 0; c < coarse.columns(); ++c) fine.labels.push_back(coarse.label(c, r));
    }
    ASSERT_TRUE(is_valid(fine));
    EXPECT_EQ(encode_quotient_map(fine).value(), encode_quotient_map(coarse).value());
}

/// Loads a lookup, by running the shader.
double mean_loads(const std::vector<uint32_t>& words, uint32_t width, uint32_t height) {
    shaders_test::ShaderCost cost;
    TestNumbers numbers(4);
    for (int i = 0; i < 2000; ++i)
        shaders_test::lookup_on_cpu(words, numbers.below(width), numbers.below(height), &cost);
    return static_cast<double>(cost.loads) / 2000;
}

TEST(QuotientMap, ALookupIsThreeLoadsAndAFourthWhereLabelsAreInATable) {
    const auto direct = words_of(figure8_relief());
    ASSERT_TRUE(is_direct(direct));
    EXPECT_EQ(mean_loads(direct, 80, 90), 3);
    FacadeMatrices far_apart = window_relief(400, 500, 5, false);  // many cells, labels that do not pack
    for (size_t i = 0; i < far_apart.material.size(); ++i) {
        far_apart.displacement_mm[i] = static_cast<int16_t>(far_apart.displacement_mm[i] * 13 + far_apart.material[i]);
        far_apart.material[i] = static_cast<uint16_t>(far_apart.material[i] * 9999);
    }
    const auto table = words_of(far_apart);
    ASSERT_FALSE(is_direct(table));
    ASSERT_FALSE(is_dense(table));
    EXPECT_EQ(mean_loads(table, 400, 500), 4);
}

TEST(QuotientMap, NoiseIsHardlyLargerThanPackedLabels) {
    for (const uint32_t labels : {2u, 5u, 32u, 1000u}) {
        const auto words = words_of(noise_relief(256, 256, 0, static_cast<int32_t>(labels) - 1, 1));
        const double packed = 256 * 256 / 8.0 * bits::bits_for(labels - 1);
        EXPECT_LE(static_cast<double>(4 * words.size()), packed * 1.01 + 224) << labels;
        EXPECT_LE(static_cast<double>(4 * words.size()), packed * 1.03) << labels;
    }
    const auto unique = words_of(noise_relief(256, 256, -32767, 32767, 65536));
    EXPECT_LE(static_cast<double>(4 * unique.size()), 256 * 256 * 4 * 1.01) << "all different";
    const auto many = words_of(noise_relief(512, 256, -500, 500, 8));
    EXPECT_TRUE(is_dense(many)) << "14 bits do not fill groups";
    EXPECT_LE(mean_loads(many, 512, 256), 2.2) << "every row and column is distinct: no class to look up";
}

TEST(QuotientMap, GoldenWords) {
    FacadeMatrices relief = uniform_relief(3, 2, 0, 0);
    fill_rectangle(relief, 1, 3, 0, 1, -2, 1);
    fill_rectangle(relief, 0, 1, 1, 2, 5, 0);
    EXPECT_EQ(words_of(relief),
              (std::vector<uint32_t>{0x00024643u, 0x00020003u, 0x0005fffeu, 0x10008002u,  // 2 x 2 classes, direct
                                     0x0000c401u, 0x00060005u, 1,           6,            // widths, groups, step, cells
                                     0b011,       0,           0,           3u << 26,     // column breaks 0 1 3
                                     0b11,        0,           0,           2u << 26,     // row breaks 0 1 2
                                     7,           0,           0,           0,            // one block, 7 mm above -2
                                     0b110,       0,           0,           0,            // column classes 0 1 1
                                     0x00002782u, 0,           0,           0}));         // cells 2, 8 / 7, 2
}

TEST(QuotientMap, RefusesHugeClaimsOfFewWords) {
    auto words = words_of(uniform_relief(8192, 8192, 0, 0));
    words[QUOTIENT_WORD_CLASSES] = 8192 | 8192 << QUOTIENT_CLASS_BITS;
    const Status status = check_quotient_map(words);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().offset, 4u * QUOTIENT_WORD_WIDTHS);
}

}  // namespace
}  // namespace citystream::codec::facade
