// The singular value form and its factorization: paper, equations 4-6, exact by rounding and lossy by rank.
#include "codec/facade/singular_value_map.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "codec/facade/facade_form_layout.h"
#include "codec/facade/raw_layout.h"
#include "codec/facade/singular_value_factorization.h"
#include "codec/facade/svd_layout.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

RunGrid grid_of(const FacadeMatrices& relief) {
    return make_run_grid(relief).value();
}

TEST(SingularValues, AreAsManyAsTheRankForWellSeparatedEntries) {
    EXPECT_EQ(singular_value_terms(encode_singular_value_map(grid_of(figure8_relief())).value()).displacement, 1u);
    // Four different rows that depend on each other: rank 2.
    FacadeMatrices relief = uniform_relief(200, 200, 0, 0);
    for (uint32_t y = 0; y < 200; ++y) {
        for (uint32_t x = 0; x < 200; ++x)
            relief.displacement_mm[y * 200 + x] = static_cast<int16_t>(y / 50 * 40 + x / 25 * 9 * (y / 50 + 1));
    }
    const auto map = encode_singular_value_map(grid_of(relief));
    ASSERT_TRUE(map.ok()) << map.error().text();
    EXPECT_EQ(singular_value_terms(*map).displacement, 2u);
}

TEST(SingularValues, OfDistinctRowsAreThoseOfTexels) {
    // The factors of a matrix of texels: X has the lengths of the singular values, Y is orthonormal over texels.
    const RunGrid grid = grid_of(window_relief(100, 90, 2, false));
    const DistinctMatrix matrix = make_distinct_matrix(grid, displacement_values(grid));
    const SingularValueFactors factors = factor_rank(matrix, 6, "displacements").value();
    ASSERT_EQ(factors.terms, 6u);
    double last = 1e30;
    for (uint32_t a = 0; a < 6; ++a) {
        for (uint32_t b = 0; b < 6; ++b) {
            double across = 0, up = 0;
            for (size_t c = 0; c < matrix.columns(); ++c)
                across += matrix.column_weight[c] * double{factors.y[c * 6 + a]} * factors.y[c * 6 + b];
            for (size_t r = 0; r < matrix.rows(); ++r)
                up += matrix.row_weight[r] * double{factors.x[r * 6 + a]} * factors.x[r * 6 + b];
            EXPECT_NEAR(across, a == b ? 1 : 0, 1e-5);
            if (a != b) {
                EXPECT_NEAR(up / last, 0, 1e-5);
                continue;
            }
            EXPECT_LE(up, last * (1 + 1e-6));
            last = up;
        }
    }
}

TEST(SingularValues, AreTheFewestThatRoundRight) {
    const RunGrid grid = grid_of(enlarged(window_relief(60, 80, 4, false), 4));
    const DistinctMatrix matrix = make_distinct_matrix(grid, displacement_values(grid));
    const SingularValueFactors exact = factor_singular_values(matrix, 1000, "displacements").value();
    ASSERT_GT(exact.terms, 1u);
    const auto worst = [&](uint32_t terms) {
        double error = 0;
        for (uint32_t r = 0; r < matrix.rows(); ++r) {
            for (uint32_t c = 0; c < matrix.columns(); ++c) {
                float sum = 0;
                for (uint32_t k = 0; k < terms; ++k)
                    sum = sum + exact.x[r * exact.terms + k] * exact.y[c * exact.terms + k];
                error = std::max(error, std::abs(double{sum} - (matrix.entry(r, c) - exact.least)));
            }
        }
        return error;
    };
    EXPECT_LT(worst(exact.terms), kMostRoundingError);
    EXPECT_GE(worst(exact.terms - 1), kMostRoundingError - 1e-3);
    EXPECT_FALSE(factor_singular_values(matrix, exact.terms - 1, "displacements").ok());
}

TEST(SingularValues, OfTooManyDistinctRowsAreRefusedUntried) {
    const RunGrid grid = grid_of(noise_relief(kMostSingularValues + 1, kMostSingularValues + 1, 0, 9, 2));
    const auto map = encode_singular_value_map(grid);
    ASSERT_FALSE(map.ok());
    EXPECT_NE(map.error().message.find("too long"), std::string::npos);
}

TEST(SingularValueMap, ReadsGivenFactors) {
    // 2 x 1 texels, D = 7 + (1.5, 4.6 rounded), M = 2, both in the one box.
    const auto word = [](float value) { return std::bit_cast<uint32_t>(value); };
    std::vector<uint32_t> words = {
        0x00064643, 0x00010002, 0x000c0009, 32,  // svd, 2 x 1, 9..12 mm, boxes
        20,         24,         1,          7,   // D
        32,         32,         0,          2,   // M
        32,         32,         0,          0,   // A
        1,          2,          0,          0,   // one box, terms
        word(2.F),  word(-3),   0,          0,   // X of D
        word(.5F),  word(-.2F), 0,          0,   // Y: 1 + 0.6
        word(3.5F), word(.8F),  0,          0,   // 7 - 2.4
        0x00020000, 0x00010000,                  // the box
    };
    const RunGrid grid = decode_singular_value_map(words).value();
    EXPECT_EQ(grid.labels, (std::vector<uint32_t>{make_label(9, 2), make_label(12, 2)}));
    EXPECT_EQ(singular_value_label(words, 1, 0), make_label(12, 2));
    EXPECT_EQ(singular_value_box(words, 1, 0), (FreeBox{0, 2, 0, 1}));
    for (const float bad : {NAN, INFINITY, -1e30F, 1.7e7F}) {
        words[21] = word(bad);
        EXPECT_FALSE(check_singular_value_map(words).ok()) << bad;
    }
}

TEST(SingularValueMap, OfARankStatesItsError) {
    const FacadeMatrices relief = enlarged(window_relief(60, 80, 4, false), 4);
    double last = 1e9;
    for (const uint32_t rank : {1u, 2u, 3u, 4u}) {
        const auto lossy = encode_lossy_singular_value_map(grid_of(relief), rank);
        ASSERT_TRUE(lossy.ok()) << lossy.error().text();
        const FacadeMatrices decoded = expand(decode_singular_value_map(lossy->words).value());
        EXPECT_EQ(decoded.material, relief.material);
        double greatest = 0, squares = 0;
        for (size_t i = 0; i < relief.material.size(); ++i) {
            const double error = decoded.displacement_mm[i] - relief.displacement_mm[i];
            greatest = std::max(greatest, std::abs(error));
            squares += error * error;
        }
        EXPECT_EQ(lossy->error.greatest_mm, greatest);
        EXPECT_NEAR(lossy->error.root_mean_square_mm, std::sqrt(squares / double(relief.material.size())), 1e-9);
        EXPECT_LT(lossy->error.root_mean_square_mm, last);
        last = lossy->error.root_mean_square_mm;
        EXPECT_EQ(singular_value_terms(lossy->words).displacement, rank);
    }
}

TEST(SingularValueMap, OfARankRefusesOpenCellsAndRankZero) {
    const RunGrid open = grid_of(enlarged(window_relief(60, 80, 4, true), 4));
    ASSERT_TRUE(open.has_open_cells());
    EXPECT_FALSE(encode_lossy_singular_value_map(open, 4).ok());
    EXPECT_FALSE(encode_lossy_singular_value_map(grid_of(figure8_relief()), 0).ok());
}

TEST(SingularValueMap, OfAllRanksIsExact) {
    const RunGrid grid = grid_of(figure8_relief());
    const LossySingularValueMap map = encode_lossy_singular_value_map(grid, 100).value();
    EXPECT_EQ(map.error.greatest_mm, 0);
    EXPECT_EQ(decode_singular_value_map(map.words).value(), grid);
}

}  // namespace
}  // namespace citystream::codec::facade
