// The paper's binary factorization: its examples and what follows from it, on distinct rows and on texels.
#include "codec/facade/binary_factorization.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "codec/facade/free_boxes.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

constexpr uint64_t kAnyNumber = UINT64_MAX;

/// A matrix of texels as distinct rows and columns.
DistinctMatrix distinct(const RunGrid& grid, const std::vector<uint32_t>& values) {
    return make_distinct_matrix(grid, values);
}

/// The same with every texel row and column as one of its own.
DistinctMatrix on_texels(const RunGrid& grid, const std::vector<uint32_t>& values) {
    DistinctMatrix matrix;
    matrix.row_weight.assign(grid.height(), 1);
    matrix.column_weight.assign(grid.width(), 1);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t y = grid.y_breaks[row]; y < grid.y_breaks[row + 1]; ++y) {
            for (uint32_t column = 0; column < grid.columns(); ++column) {
                matrix.entries.insert(matrix.entries.end(), grid.x_breaks[column + 1] - grid.x_breaks[column],
                                      values[size_t{row} * grid.columns() + column]);
            }
        }
    }
    return matrix;
}

/// Entries given back, and how many terms cover each.
struct Covered {
    std::vector<uint32_t> entries, hits;
};
Covered put_together(const DistinctMatrix& matrix, const BinaryFactors& factors) {
    Covered result{std::vector<uint32_t>(matrix.entries.size(), factors.base),
                   std::vector<uint32_t>(matrix.entries.size(), 0)};
    for (const BinaryTerm& term : factors.terms) {
        for (const size_t row : term.rows) {
            for (const uint32_t column : term.columns) {
                const size_t at = row * matrix.columns() + column;
                if (result.hits[at]++ == 0) result.entries[at] = term.value;
            }
        }
    }
    return result;
}

TEST(BinaryFactorization, OfFigure8HasOneTerm) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();
    const auto factors = factor_binary(distinct(grid, displacement_values(grid)), kAnyNumber);
    ASSERT_TRUE(factors.ok());
    ASSERT_EQ(factors->terms.size(), 1u);
    EXPECT_EQ(factors->base, 32768u);
    EXPECT_EQ(factors->terms[0].value, 32768u + 25);
}

TEST(BinaryFactorization, TakesTheLargestCliqueOnTheWay) {
    // Entries equal to the maximum as in figure 9: growing goes on past the best clique (2 rows x 3 columns).
    const std::vector<uint32_t> entries = {5, 5, 5, 0, 0,  //
                                           5, 5, 5, 0, 0,  //
                                           0, 0, 5, 0, 0,  //
                                           0, 0, 0, 1, 0};
    const DistinctMatrix matrix{{1, 1, 1, 1}, {1, 1, 1, 1, 1}, entries, {}, {}};
    const auto factors = factor_binary(matrix, kAnyNumber);
    ASSERT_TRUE(factors.ok());
    ASSERT_EQ(factors->terms.size(), 3u);
    EXPECT_EQ(factors->terms[0].rows, (std::vector<uint32_t>{0, 1}));
    EXPECT_EQ(factors->terms[0].columns, (std::vector<uint32_t>{0, 1, 2}));
    EXPECT_EQ(factors->terms[1].rows, (std::vector<uint32_t>{2}));
    EXPECT_EQ(factors->terms[2].value, 1u);
}

TEST(BinaryFactorization, OfDifferentEntriesNeedsATermForEachButTheLeast) {
    DistinctMatrix matrix{{1, 1, 1}, {1, 1, 1, 1}, {}, {}, {}};
    for (uint32_t i = 0; i < 12; ++i) matrix.entries.push_back(i * i);
    const auto factors = factor_binary(matrix, kAnyNumber);
    ASSERT_TRUE(factors.ok());
    EXPECT_EQ(factors->terms.size(), 11u);
    EXPECT_FALSE(factor_binary(matrix, 10).ok());
    EXPECT_FALSE(factor_binary_first_match(matrix, 10).ok());
}

TEST(BinaryFactorization, GivesEveryEntryBackWithTermsThatDoNotOverlap) {
    for (const ReliefCase& c : small_reliefs()) {
        const RunGrid grid = make_run_grid(c.relief).value();
        for (const auto& values : {displacement_values(grid), material_values(grid), grow_free_boxes(grid).box_index}) {
            const DistinctMatrix matrix = distinct(grid, values);
            const auto factors = factor_binary(matrix, kAnyNumber);
            ASSERT_TRUE(factors.ok()) << c.name;
            const Covered covered = put_together(matrix, *factors);
            EXPECT_EQ(covered.entries, matrix.entries) << c.name;
            EXPECT_LE(*std::max_element(covered.hits.begin(), covered.hits.end()), 1u) << c.name;
            const auto falls = [](const BinaryTerm& a, const BinaryTerm& b) { return a.value > b.value; };
            EXPECT_TRUE(std::is_sorted(factors->terms.begin(), factors->terms.end(), falls)) << c.name;
        }
    }
}

TEST(BinaryFactorization, OfFirstMatchesGivesEveryEntryBackWithFewerTerms) {
    for (const ReliefCase& c : large_reliefs()) {
        const RunGrid grid = make_run_grid(c.relief).value();
        for (const auto& values : {displacement_values(grid), material_values(grid), grow_free_boxes(grid).box_index}) {
            const DistinctMatrix matrix = distinct(grid, values);
            const auto factors = factor_binary_first_match(matrix, kAnyNumber);
            ASSERT_TRUE(factors.ok()) << c.name;
            EXPECT_EQ(put_together(matrix, *factors).entries, matrix.entries) << c.name;
        }
    }
    const RunGrid grid = make_run_grid(window_relief(400, 500, 5, false)).value();
    const DistinctMatrix matrix = distinct(grid, displacement_values(grid));
    EXPECT_LT(factor_binary_first_match(matrix, kAnyNumber)->terms.size(),
              factor_binary(matrix, kAnyNumber)->terms.size());
}

TEST(BinaryFactorization, NeedsAsManyTermsOnDistinctRowsAsOnTexels) {
    for (const uint64_t seed : {1, 2, 3}) {
        const RunGrid grid = make_run_grid(window_relief(140, 120, seed, seed == 2)).value();
        for (const auto& values : {displacement_values(grid), material_values(grid), grow_free_boxes(grid).box_index}) {
            const auto few = factor_binary(distinct(grid, values), kAnyNumber);
            const auto many = factor_binary(on_texels(grid, values), kAnyNumber);
            EXPECT_EQ(few->terms.size(), many->terms.size()) << "seed " << seed;
        }
    }
}

TEST(BinaryFactorization, FindsHitsSoonerWithLargeTermsFirst) {
    const RunGrid grid = make_run_grid(window_relief(400, 500, 5, false)).value();
    const DistinctMatrix matrix = distinct(grid, grow_free_boxes(grid).box_index);
    BinaryFactors factors = factor_binary(matrix, kAnyNumber).value();
    const double before = mean_words_searched(matrix, factors);
    put_large_terms_first(factors);
    EXPECT_LT(mean_words_searched(matrix, factors), before / 2);
    EXPECT_EQ(put_together(matrix, factors).entries, matrix.entries);
}

TEST(BinaryFactorization, CountsTheWordsOfASearch) {
    // 33 terms of one texel each and 31 texels without: 32 hits in the first pair of words, 32 texels read two pairs.
    DistinctMatrix matrix{{1}, std::vector<uint32_t>(64, 1), std::vector<uint32_t>(64, 7), {}, {}};
    for (uint32_t i = 0; i < 33; ++i) matrix.entries[i] = 100 + i;
    const BinaryFactors factors = factor_binary(matrix, kAnyNumber).value();
    ASSERT_EQ(factors.terms.size(), 33u);
    EXPECT_DOUBLE_EQ(mean_words_searched(matrix, factors), (32 * 2 + 32 * 4) / 64.0);
}

TEST(DistinctMatrix, CountsTheTexelsOfItsRowsAndColumns) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();
    const DistinctMatrix matrix = distinct(grid, displacement_values(grid));
    EXPECT_EQ(matrix.row_weight, (std::vector<uint32_t>{48, 42}));
    EXPECT_EQ(matrix.column_weight, (std::vector<uint32_t>{40, 40}));
    EXPECT_EQ(matrix.entries, (std::vector<uint32_t>{32768, 32768, 32768, 32793}));
    EXPECT_EQ(matrix.row_of, (std::vector<uint32_t>{0, 1, 0, 1, 0, 1, 0}));
}

}  // namespace
}  // namespace citystream::codec::facade
