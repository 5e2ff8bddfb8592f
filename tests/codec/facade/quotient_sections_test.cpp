// The sections of the quotient and tiled forms against what they are by definition.
#include "codec/facade/quotient_sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "codec/facade/quotient_parts.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

TEST(QuotientParts, KeepEveryDistinctRowAndColumnOnce) {
    for (const ReliefCase& relief : small_reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        const QuotientParts parts = make_quotient(grid);
        EXPECT_EQ(expand_quotient(parts), grid) << relief.name;
        const auto column = [&](uint32_t c) {
            std::vector<uint32_t> labels;
            for (uint32_t r = 0; r < parts.rows; ++r) labels.push_back(parts.label(c, r));
            return labels;
        };
        for (uint32_t a = 0; a < parts.columns; ++a) {
            for (uint32_t b = 0; b < a; ++b) EXPECT_NE(column(a), column(b)) << relief.name;
        }
        uint32_t next = 0;  // numbered by first use
        for (const uint32_t c : parts.x_classes) {
            EXPECT_LE(c, next);
            next = std::max(next, c + 1);
        }
        EXPECT_EQ(next, parts.columns);
    }
}

TEST(QuotientSections, FieldsComeBackAndSparseOnesStayInTheirGroups) {
    TestNumbers numbers(1);
    for (uint32_t bits = 0; bits <= 32; ++bits) {
        std::vector<uint32_t> values(101);
        for (uint32_t& value : values)
            value = bits == 0 ? 0 : (numbers.below(1u << 31) << 1 ^ numbers.below(1u << 31)) >> (32 - bits);
        for (const bool dense : {false, true}) {
            std::vector<uint32_t> words = {1, 2, 3, 4};
            append_fields(words, values, bits, dense);
            ASSERT_EQ(words.size(), 4 + 4 * field_groups(values.size(), bits, dense)) << bits;
            for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(read_field(words, 1, i, bits, dense), values[i]);
        }
        EXPECT_EQ(field_groups(101, bits, true), (101 * bits + 127) / 128) << bits;
        const uint32_t in_group = bits == 0 ? 101 : 128 / bits;
        EXPECT_EQ(field_groups(101, bits), bits == 0 ? 0 : (101 + in_group - 1) / in_group) << bits;
    }
    EXPECT_EQ(field_groups(0, 7), 0u);
}

TEST(QuotientSections, EveryTexelFindsItsRunInOneGroup) {
    TestNumbers numbers(2);
    for (const uint32_t size : {1u, 2u, 87u, 88u, 89u, 176u, 1000u, 8191u, 8192u}) {
        for (const uint32_t longest : {1u, 3u, 40u, 300u, 8192u}) {
            std::vector<uint32_t> breaks = {0};
            while (breaks.back() < size) breaks.push_back(std::min(size, breaks.back() + 1 + numbers.below(longest)));
            std::vector<uint32_t> words;
            append_breaks(words, breaks);
            ASSERT_EQ(words.size(), 4 * break_groups(size));
            EXPECT_EQ(read_breaks(words, 0, size), breaks);
            for (uint32_t run = 0; run + 1 < breaks.size(); ++run) {
                for (const uint32_t texel : {breaks[run], (breaks[run] + breaks[run + 1]) / 2, breaks[run + 1] - 1}) {
                    const facade::Run found = run_at(words, 0, texel);
                    ASSERT_EQ(found.index, run) << size << " texel " << texel;
                    ASSERT_EQ(found.begin, breaks[run]);
                    ASSERT_EQ(found.end, breaks[run + 1]);
                }
            }
        }
    }
}

TEST(QuotientSections, BlockMaximaAreTheLeastBytesNotBelowAnyTexel) {
    for (const ReliefCase& relief : large_reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        const QuotientParts parts = make_quotient(grid);
        const DepthRange depths = grid.depths();
        std::vector<int16_t> displacements;
        for (const uint32_t label : parts.labels) displacements.push_back(static_cast<int16_t>(displacement_of(label)));
        const auto maxima = block_maxima({parts.x_breaks, parts.x_classes, parts.columns},
                                         {parts.y_breaks, parts.y_classes, parts.rows}, displacements, depths);
        const uint32_t side = 1u << BLOCK_LOG2, across = (grid.width() + side - 1) / side;
        ASSERT_EQ(maxima.size(), size_t{across} * ((grid.height() + side - 1) / side));
        EXPECT_EQ(block_groups(grid.width(), grid.height()), (maxima.size() + 15) / 16);
        const int32_t step = (depths.max_mm - depths.min_mm + 254) / 255;
        for (uint32_t block = 0; block < maxima.size(); ++block) {
            int32_t greatest = kOpenDisplacement;
            for (uint32_t y = block / across * side; y < std::min(grid.height(), (block / across + 1) * side); ++y) {
                for (uint32_t x = block % across * side; x < std::min(grid.width(), (block % across + 1) * side); ++x)
                    greatest = std::max<int32_t>(greatest, relief.relief.displacement_mm[size_t{y} * grid.width() + x]);
            }
            const auto level = static_cast<int32_t>(maxima[block]);
            ASSERT_LE(level, BLOCK_MAX_LEVELS) << relief.name;
            ASSERT_GE(depths.min_mm + level * step, greatest) << relief.name;
            ASSERT_TRUE(level == 0 || depths.min_mm + (level - 1) * step < greatest) << relief.name;
        }
    }
}

TEST(QuotientSections, LabelNumbersAreExactAndNarrow) {
    const auto expect_exact = [](const std::vector<uint32_t>& labels, uint32_t bits) {
        const LabelCode code = LabelCode::for_labels(labels, RunGrid{{}, {}, labels}.depths());
        EXPECT_EQ(code.bits(), bits);
        for (const uint32_t label : labels) {
            EXPECT_LT(uint64_t{code.number_of(label)}, uint64_t{1} << code.bits());
            EXPECT_EQ(code.label_of(code.number_of(label)), label);
        }
    };
    expect_exact({make_label(0, 0)}, 0);
    expect_exact({make_label(-25, 0), make_label(50, 1), make_label(0, 2)}, 2 + 2);  // steps of 25
    expect_exact({make_label(-25, 0), make_label(50, 1), make_label(kOpenDisplacement, 0)}, 2 + 1);
    expect_exact({make_label(kOpenDisplacement, 9)}, 1 + 4);
    expect_exact({make_label(-32767, 65535), make_label(32767, 0), make_label(-32766, 0), make_label(-32768, 3)}, 32);
}

}  // namespace
}  // namespace citystream::codec::facade
