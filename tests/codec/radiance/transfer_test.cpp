// The transfer matrix: quarters that add up, light that is neither made nor lost, rows kept once.
#include "codec/radiance/transfer.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "tests/codec/radiance/radiance_scenes.h"

namespace citystream::codec::radiance {
namespace {

/// Of each receiver and texel, quarters over all local directions.
std::vector<uint32_t> column_sums(const Transfer& t, uint32_t receiver, uint32_t local_count) {
    std::vector<uint32_t> sums(t.columns, 0);
    for (uint32_t i = t.row_begin[receiver * local_count]; i < t.row_begin[(receiver + 1) * local_count]; ++i)
        sums[t.column[i]] += static_cast<uint32_t>(t.quarters[i]);
    return sums;
}

void expect_sound(const Transfer& t, const VisibilityTile& tile, const LocalDirections& local) {
    ASSERT_EQ(t.rows(), tile.receivers() * local.count());
    ASSERT_EQ(t.columns, texel_count(tile.side));
    for (uint32_t j = 0; j < t.rows(); ++j) {
        for (uint32_t i = t.row_begin[j]; i < t.row_begin[j + 1]; ++i) {
            EXPECT_GE(t.quarters[i], 1);
            if (i == t.row_begin[j]) continue;
            EXPECT_LT(t.column[i - 1], t.column[i]);
        }
    }
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const auto sums = column_sums(t, r, local.count());
        std::vector<uint32_t> seen(t.columns, 0);
        for (uint32_t s = 0; s < sample_count(tile.side); ++s) seen[texel_of_sample(tile.side, s)] += tile.sees(r, s);
        EXPECT_EQ(sums, seen);
    }
}

/// Sky factor of the receivers' planes, by averaged or by central cosines: irradiance under a sky of radiance 1.
double irradiance(const Transfer& t, uint32_t side, const LocalDirections& local, bool averaged) {
    const CellAverages averages = cell_averages(local);
    double sum = 0;
    for (uint32_t j = 0; j < local.count(); ++j) {
        const double centre = static_cast<double>(local.direction(j)[2]) / kFrameOne;
        for (uint32_t i = t.row_begin[j]; i < t.row_begin[j + 1]; ++i)
            sum +=
                (averaged ? averages.cosine[j] : centre) * t.quarters[i] * 0.25 * cell_solid_angle(side, t.column[i]);
    }
    return sum;
}

TEST(Transfer, HoldsEveryVisibleSampleOnceByEitherRule) {
    const LocalDirections local(8);
    const VisibilityTile tiles[] = {open_ground(32), open_sphere(20, 8), noise(6, 8, 1),
                                    fence(3, 8),     noise(2, 1, 2),     noise(2, 3, 2)};
    for (const VisibilityTile& tile : tiles) {
        for (const auto rule : {TransferRule::kSamples, TransferRule::kTexels})
            expect_sound(make_transfer(tile, local, rule), tile, local);
    }
}

TEST(Transfer, OfOpenGroundHasAsManyEntriesAsTheRuleSays) {
    // Texels of half the cube each: four quarters at one direction, or spread over several.
    const LocalDirections local(8);
    const VisibilityTile ground = open_ground(32);
    const Transfer literal = make_transfer(ground, local, TransferRule::kTexels);
    EXPECT_EQ(literal.nonzeros(), texel_count(32) / 2);
    for (const int8_t q : literal.quarters) EXPECT_EQ(q, 4);
    const Transfer samples = make_transfer(ground, local);
    EXPECT_GT(samples.nonzeros(), 3500u);
    EXPECT_LT(samples.nonzeros(), 3800u);
    EXPECT_EQ(std::accumulate(samples.quarters.begin(), samples.quarters.end(), 0u), 4 * texel_count(32) / 2);
}

TEST(Transfer, OfOneLocalDirectionAndSixTexelsIsVisibilityItself) {
    const LocalDirections local(1);
    const VisibilityTile tile = open_ground(1);
    const Transfer t = make_transfer(tile, local);
    EXPECT_EQ(t.rows(), 1u);
    EXPECT_EQ(t.column, (std::vector<uint16_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(t.quarters, (std::vector<int8_t>{2, 2, 2, 2, 4}));
}

TEST(Transfer, OfNothingSeenAndOfNoReceiversIsEmpty) {
    VisibilityTile tile{8, {}, {}, {}};
    EXPECT_EQ(make_transfer(tile, LocalDirections(8)).rows(), 0u);
    tile.add_receiver(pack_frame({0, 0, 1}));
    const Transfer t = make_transfer(tile, LocalDirections(8));
    EXPECT_EQ(t.rows(), 64u);
    EXPECT_EQ(t.nonzeros(), 0u);
}

TEST(Transfer, IgnoresBitsBelowTheReceiversPlane) {
    VisibilityTile tile = open_sphere(9, 8);
    const Transfer clean = make_transfer(tile, LocalDirections(4));
    std::fill(tile.words.begin(), tile.words.end(), ~0u);
    EXPECT_EQ(make_transfer(tile, LocalDirections(4)), clean);
    clear_below_planes(tile);
    EXPECT_EQ(tile, open_sphere(9, 8));
}

TEST(Transfer, DependsOnTheFrameAloneAndNotOnItsNumber) {
    VisibilityTile tile = open_sphere(70, 4);  // more frames than tables are kept
    VisibilityTile twice = tile;
    for (uint32_t r = 0; r < 70; ++r) {
        twice.add_receiver(tile.frames[tile.frame_of[69 - r]]);
        std::copy_n(tile.of(69 - r).begin(), tile.words_a_receiver(), twice.words.end() - tile.words_a_receiver());
    }
    const LocalDirections local(4);
    const Transfer t = make_transfer(twice, local);
    for (uint32_t r = 0; r < 70; ++r) EXPECT_EQ(column_sums(t, r, 16), column_sums(t, 139 - r, 16));
    EXPECT_EQ(make_transfer(tile, local).nonzeros() * 2, t.nonzeros());
}

TEST(Transfer, OfAnOpenReceiverGathersTheHemisphere) {
    const LocalDirections local(8);
    const VisibilityTile tile = open_sphere(40, 32);
    const Transfer t = make_transfer(tile, local);
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const auto sums = column_sums(t, r, local.count());
        double total = 0;
        for (uint32_t k = 0; k < t.columns; ++k) {
            EXPECT_LE(sums[k], 4u);
            total += sums[k] * 0.25 * cell_solid_angle(32, k);
        }
        EXPECT_NEAR(total, 2 * kPi, 0.01 * 2 * kPi);
    }
}

TEST(Transfer, GivesOpenGroundItsIrradianceByAveragedCosines) {
    for (const uint32_t side : {8u, 12u}) {
        const LocalDirections local(side);
        const Transfer t = make_transfer(open_ground(32), local);
        EXPECT_NEAR(irradiance(t, 32, local, true), kPi, 0.005 * kPi);
    }
    const LocalDirections local(8);
    const double central = irradiance(make_transfer(open_ground(32), local), 32, local, false);
    EXPECT_GT(central, 1.031 * kPi);
    EXPECT_LT(central, 1.034 * kPi);
}

TEST(Transfer, MeetsTheClosedFormBesideAnInfiniteWall) {
    // An infinitely long wall along y: ground whose horizon it raises by an angle a sees (1 + cos a) / 2 of its sky, a
    // wall sees half. Where a wall hides less than the lowest row of directions stands for (27 degrees of elevation for
    // 8 x 8), that row's mean cosine is too much for what is hidden, so that finer directions are needed.
    const auto factor = [](double elevation, uint32_t local_side) {
        const LocalDirections local(local_side);
        const auto beside = cast_rays({{{0, 0, 0}, {0, 0, 1}}}, 32, 0, [&](const Receiver&, const Point& d) {
            return d[2] > 0 && (d[0] <= 0 || std::atan2(d[2], d[0]) > elevation);
        });
        return irradiance(make_transfer(beside, local), 32, local, true) / kPi;
    };
    for (const double elevation : {0.5, 0.8, 1.1, kPi / 2}) {
        const double exact = (1 + std::cos(elevation)) / 2;
        EXPECT_NEAR(factor(elevation, 8), exact, 0.015 * exact) << elevation;
    }
    for (const double elevation : {0.1, 0.2, 0.5, 0.8, 1.1, kPi / 2}) {
        const double exact = (1 + std::cos(elevation)) / 2;
        EXPECT_NEAR(factor(elevation, 12), exact, 0.015 * exact) << elevation;
    }
    const LocalDirections local(8);
    const auto wall =
        cast_rays({{{0, 0, 0}, {-1, 0, 0}}}, 32, 0, [](const Receiver&, const Point& d) { return d[2] > 0; });
    EXPECT_NEAR(irradiance(make_transfer(wall, local), 32, local, true) / kPi, 0.5, 0.0075);
}

TEST(DistinctRows, GiveAllRowsBackAndKeepEachOnce) {
    const LocalDirections local(4);
    for (const VisibilityTile& tile :
         {TowerCity().visibility(32, 8), noise(5, 8, 3), fence(12, 8), VisibilityTile{8, {}, {}, {}}}) {
        const Transfer t = make_transfer(tile, local);
        const DistinctRows distinct = distinct_rows(t);
        EXPECT_EQ(all_rows(distinct), t);
        EXPECT_EQ(distinct_rows(distinct.rows).rows, distinct.rows);
    }
    EXPECT_EQ(distinct_rows(make_transfer(fence(12, 8), local)).rows.rows(), 3 * 16u);
}

TEST(DistinctRows, AreMadeReceiverByReceiverWithoutTheWhole) {
    for (const uint32_t local_side : {1u, 3u, 8u}) {
        const LocalDirections local(local_side);
        for (const VisibilityTile& tile : {TowerCity().visibility(32, 8, 0.3), noise(5, 7, 3), fence(12, 8),
                                           open_sphere(300, 5), open_ground(1), VisibilityTile{8, {}, {}, {}}}) {
            DistinctRowMaker maker(tile.side, local);
            for (uint32_t r = 0; r < tile.receivers(); ++r)
                maker.add(tile.frame_of[r], tile.frames[tile.frame_of[r]], tile.of(r));
            const uint64_t nonzeros = maker.nonzeros();
            const DistinctRows made = maker.take(), expected = distinct_rows(make_transfer(tile, local));
            EXPECT_EQ(made.rows, expected.rows);
            EXPECT_EQ(made.row_of, expected.row_of);
            EXPECT_EQ(nonzeros, expected.rows.nonzeros());
        }
    }
}

TEST(LocalOfSamples, IsTheNearestDirectionOfEverySampleAboveThePlane) {
    std::mt19937_64 random(4);
    for (const uint32_t local_side : {1u, 4u, 8u, 12u}) {
        const LocalDirections local(local_side);
        for (const uint32_t side : {1u, 5u, 16u}) {
            const Frame frame = unpack_frame(static_cast<uint32_t>(random()));
            const auto nearest = local_of_samples(frame, side, local);
            const auto of_texels = local_of_samples(frame, side, local, TransferRule::kTexels);
            const auto above = samples_above(frame, side);
            for (uint32_t s = 0; s < sample_count(side); ++s) {
                const auto direction = cell_direction(kSamplesAcross * side, s);
                const auto texel = cell_direction(side, texel_of_sample(side, s));
                ASSERT_EQ((above[s / 32] >> s % 32 & 1) != 0, frame.sees(direction));
                if (frame.sees(direction)) {
                    ASSERT_EQ(nearest[s], local.nearest_of_all(frame.to_local(direction)));
                }
                if (frame.sees(texel)) {
                    ASSERT_EQ(of_texels[s], local.nearest_of_all(frame.to_local(texel)));
                }
            }
        }
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
