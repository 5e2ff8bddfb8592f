// A matrix within a stated bound of what receivers see: rows that are one, residuals that are left out.
#include "codec/radiance/near_rows.h"

#include <gtest/gtest.h>

#include <numbers>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/radiance_resident.h"
#include "tests/codec/radiance/lattice_scene.h"
#include "tests/codec/radiance/transfer_cases.h"

namespace citystream::codec::radiance {
namespace {

constexpr std::array<double, 7> kBounds = {0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2};
constexpr uint32_t kLocalSide = 8, kTexelsAcross = 16;

/// Of a row, as the bound counts it.
uint32_t units_between(const RowBound& bound, std::span<const int> from, std::span<const int> to) {
    uint32_t units = 0;
    for (size_t k = 0; k < from.size(); ++k)
        units += bound.weights[k] * static_cast<uint32_t>(std::abs(from[k] - to[k]));
    return units;
}

std::vector<int> dense_row(const Transfer& transfer, uint32_t row) {
    std::vector<int> dense(transfer.columns, 0);
    for (uint32_t i = transfer.row_begin[row]; i < transfer.row_begin[row + 1]; ++i)
        dense[transfer.column[i]] = int{transfer.quarters[i]};
    return dense;
}

TEST(RowBound, IsThePartOfAnEvenSkyThatADirectionGets) {
    for (const uint32_t side : {4U, 16U, 32U}) {
        for (const uint32_t local_count : {1U, 16U, 64U}) {
            const RowBound bound = row_bound(side, local_count, 0.1);
            ASSERT_EQ(bound.weights.size(), texel_count(side));
            double whole = 0;
            for (const uint32_t weight : bound.weights) whole += kSamplesInTexel * weight * bound.unit;
            // All texels are two hemispheres, each M times what a direction gets; weights are rounded up.
            EXPECT_GE(whole, 2.0 * local_count);
            EXPECT_LT(whole, 1.01 * 2.0 * local_count);
            EXPECT_LE(bound.most * bound.unit, 0.1);
            EXPECT_GT((bound.most + 1) * bound.unit, 0.1);
        }
    }
    EXPECT_EQ(row_bound(8, 4, 0).most, 0U);
    EXPECT_EQ(row_bound(8, 4, -1).most, 0U);
    EXPECT_EQ(row_bound(8, 4, 7).most, row_bound(8, 4, 1).most);
}

/// Distinct rows of made-up receivers.
DistinctRows some_rows() {
    return distinct_rows(
        make_transfer(first_receivers(TowerCity().visibility(16, kTexelsAcross), 120), LocalDirections(kLocalSide)));
}

TEST(NearRows, MissEachRowByNoMoreThanTheBoundAndAddNothing) {
    const DistinctRows distinct = some_rows();
    uint32_t fewest = distinct.rows.rows();
    for (const double error : kBounds) {
        const RowBound bound = row_bound(kTexelsAcross, kLocalSide * kLocalSide, error);
        const NearRows near = merge_near_rows(distinct, kLocalSide * kLocalSide, bound);
        ASSERT_EQ(near.distinct.row_of.size(), distinct.row_of.size());
        ASSERT_EQ(near.missed.size(), near.distinct.rows.rows());
        std::vector<uint32_t> missed(near.missed.size(), 0);
        for (size_t i = 0; i < distinct.row_of.size(); ++i) {
            const auto held = dense_row(near.distinct.rows, near.distinct.row_of[i]);
            const auto whole = dense_row(distinct.rows, distinct.row_of[i]);
            for (size_t k = 0; k < held.size(); ++k) ASSERT_LE(held[k], whole[k]);
            uint32_t& most = missed[near.distinct.row_of[i]];
            most = std::max(most, units_between(bound, whole, held));
        }
        EXPECT_EQ(missed, near.missed) << error;
        for (const uint32_t units : missed) EXPECT_LE(units, bound.most);
        EXPECT_LE(near.distinct.rows.rows(), fewest);
        fewest = near.distinct.rows.rows();
        EXPECT_EQ(near.quarters == 0, error == 0 || near.distinct.rows.rows() == distinct.rows.rows());
    }
    EXPECT_LT(2 * fewest, distinct.rows.rows());
}

TEST(NearRows, AreAllRowsWhereNothingMayBeMissed) {
    for (const TransferCase& c : transfer_cases()) {
        const uint32_t side = texels_across_of(c.transfer.columns);
        if (side == 0) continue;
        const DistinctRows distinct = distinct_rows(c.transfer);
        const NearRows near = merge_near_rows(distinct, c.local_count, row_bound(side, c.local_count, 0));
        EXPECT_EQ(near.distinct.rows, distinct.rows) << c.name;
        EXPECT_EQ(near.distinct.row_of, distinct.row_of) << c.name;
    }
}

class LossyLayer : public ::testing::Test {
  protected:
    static const std::vector<RadianceLayerStep>& layer() {
        static const auto steps =
            encode_radiance_layer(LatticeScene::towers(32, 2, 7).tile(32, 11, kTexelsAcross), kLocalSide, 1);
        return *steps;
    }
    static std::vector<uint32_t> words_of(const MatrixOptions& options, MatrixLoss* loss = nullptr) {
        const LayerPrefix prefix(layer(), layer().size());
        auto words = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, options, loss);
        EXPECT_TRUE(words.ok()) << words.error().text();
        return std::move(*words);
    }
};

using Light = std::vector<Channels<double>>;

/// 1,000 lights in the form of what tells errors best: lone bright texels, halves of the sky, noise over many orders.
Light random_light(uint64_t seed, uint32_t columns) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    Light light(columns, Channels<double>{});
    for (uint32_t k = 0; k < columns; ++k) {
        const double solid_angle = cell_solid_angle(kTexelsAcross, k);
        const std::array<double, 3> radiance = {uniform(random), uniform(random) < 0.5 ? 1.0 : 0.0,
                                                std::pow(10, -6 * uniform(random))};
        for (size_t c = 0; c < 3; ++c) light[k][c] = radiance[c] * solid_angle;
    }
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<uint32_t>(random() % columns);
        light[k][0] = cell_solid_angle(kTexelsAcross, k);
    }
    return light;
}

/// Greatest and least of what rows get less than they should, over all lights: parts of an even sky as bright as the
/// brightest texel.
std::pair<double, double> measured_errors(const ResidentRadianceView& exact, const ResidentRadianceView& lossy) {
    const double even = 2 * std::numbers::pi / (kLocalSide * kLocalSide) / kQuarter;
    double most = 0, least = 0;
    for (uint64_t seed = 0; seed < 334; ++seed) {
        const Light light = random_light(seed, exact.columns());
        const auto whole = exact.product(std::span<const Channels<double>>(light));
        const auto held = lossy.product(std::span<const Channels<double>>(light));
        for (uint32_t r = 0; r < exact.receivers(); ++r) {
            for (uint32_t j = 0; j < exact.locals(); ++j) {
                for (size_t c = 0; c < 3; ++c) {
                    const double less = (whole[exact.row_of(r, j)][c] - held[lossy.row_of(r, j)][c]) / even;
                    most = std::max(most, less);
                    least = std::min(least, less);
                }
            }
        }
    }
    return {most, least};
}

TEST_F(LossyLayer, HasRowsWithinItsDeclaredBoundUnderAThousandLights) {
    const auto exact_words = words_of(MatrixForm::kBiclusters);
    const auto exact_layer = *RadianceLayerView::create(exact_words);
    const auto exact = *ResidentRadianceView::create(exact_layer.matrix());
    for (const MatrixOptions options :
         {MatrixOptions(MatrixForm::kBiclusters, 0.02), MatrixOptions(MatrixForm::kBiclusters, 0.1),
          MatrixOptions(MatrixForm::kRows, 0.1)}) {
        MatrixLoss loss;
        const auto words = words_of(options, &loss);
        const auto layer = *RadianceLayerView::create(words);
        const auto [most, least] = measured_errors(exact, *ResidentRadianceView::create(layer.matrix()));
        constexpr double kRounding = 1e-12;
        EXPECT_LE(loss.row_error, options.row_error);
        EXPECT_GT(loss.row_error, 0.9 * options.row_error) << "little of the bound is used";
        EXPECT_GT(loss.quarters, 0U);
        EXPECT_LE(most, loss.row_error + kRounding);
        EXPECT_GT(most, 0.2 * options.row_error) << "the lights are too easy";
        EXPECT_GE(least, -kRounding);
    }
}

TEST_F(LossyLayer, TakesFewerBytesAndLessWorkTheGreaterTheBound) {
    for (const MatrixForm form : {MatrixForm::kBiclusters, MatrixForm::kRows}) {
        size_t bytes = ~size_t{0};
        uint32_t links = ~0U;
        double error = -1;
        for (const double bound : kBounds) {
            MatrixLoss loss;
            const auto words = words_of({form, bound}, &loss);
            const auto layer = *RadianceLayerView::create(words);
            EXPECT_LE(words.size(), bytes) << bound;
            EXPECT_LE(layer.matrix()[RADIANCE_WORD_LINKS], links) << bound;
            EXPECT_GE(loss.row_error, error);
            bytes = words.size();
            links = layer.matrix()[RADIANCE_WORD_LINKS];
            error = loss.row_error;
        }
        EXPECT_LT(5 * bytes, 4 * words_of(form).size()) << "a fifth of the light should save more";
    }
}

TEST_F(LossyLayer, IsTheExactOneWithoutABound) {
    for (const MatrixForm form : {MatrixForm::kBiclusters, MatrixForm::kRows}) {
        MatrixLoss loss{1, 1};
        EXPECT_EQ(words_of({form, 0}, &loss), words_of(form));
        EXPECT_EQ(loss.row_error, 0);
        EXPECT_EQ(loss.quarters, 0U);
    }
    EXPECT_EQ(words_of({MatrixForm::kBiclusters, 0.05}), words_of({MatrixForm::kBiclusters, 0.05}));
}

}  // namespace
}  // namespace citystream::codec::radiance
