// Light by clusters, by entries, by the full matrix and by bits is the same light.
#include "codec/radiance/transfer_product.h"

#include <gtest/gtest.h>

#include <cmath>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/source_light.h"
#include "tests/codec/radiance/transfer_cases.h"

namespace citystream::codec::radiance {
namespace {

template <typename Number>
std::vector<Channels<Number>> some_light(uint32_t columns, uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Channels<Number>> light(columns);
    for (auto& value : light) {
        for (Number& v : value) v = static_cast<Number>(random() % 1000) / 4;
    }
    return light;
}

template <typename Number>
std::span<const Channels<Number>> view(const std::vector<Channels<Number>>& light) {
    return light;
}

TEST(TransferProduct, IsTheSameInEveryWayInWholeNumbers) {
    for (const TransferCase& c : transfer_cases()) {
        std::mt19937_64 random(4);
        std::vector<Channels<uint32_t>> light(c.transfer.columns);
        for (auto& value : light) {
            for (uint32_t& v : value) v = static_cast<uint32_t>(random());
        }
        const auto expected = product_by_entries(c.transfer, view(light));
        EXPECT_EQ(product_by_dense(std::span<const int8_t>(dense_quarters(c.transfer)), view(light)), expected);
        for (const Seeding seeding : {Seeding::kEntry, Seeding::kRow})
            EXPECT_EQ(product_by_clusters(find_biclusters(c.transfer, {seeding, 1, 0}), view(light)), expected)
                << c.name;
        const DistinctRows distinct = distinct_rows(c.transfer);
        EXPECT_EQ(spread_rows(distinct.row_of, product_by_entries(distinct.rows, view(light))), expected);
    }
}

TEST(TransferProduct, OfBitsNeedsNoMatrix) {
    const LocalDirections local(4);
    for (VisibilityTile tile :
         {open_sphere(5, 8), first_receivers(TowerCity().visibility(64, 8), 40), noise(4, 6, 2)}) {
        clear_below_planes(tile);
        std::vector<std::vector<uint16_t>> tables;
        for (const uint32_t code : tile.frames)
            tables.push_back(local_of_samples(unpack_frame(code), tile.side, local));
        const auto light = some_light<uint32_t>(texel_count(tile.side), 3);
        EXPECT_EQ(product_by_bits(tile, local.count(), tables, view(light)),
                  product_by_entries(make_transfer(tile, local), view(light)));
    }
}

TEST(TransferProduct, OfQuarterLightIsExactInFloats) {
    // Light in multiples of 1/4 below 2^10: every sum is a float, whatever the way.
    for (const TransferCase& c : transfer_cases()) {
        const auto light = some_light<float>(c.transfer.columns, 5);
        EXPECT_EQ(product_by_clusters(find_biclusters(c.transfer, {}), view(light)),
                  product_by_entries(c.transfer, view(light)))
            << c.name;
    }
}

/// The greatest difference of clusters in floats to entries in doubles, over rows that do not see texel `sun`, relative
/// to the greatest row.
double leak(const Transfer& t, std::vector<Channels<float>> light, uint32_t sun, float radiance) {
    light[sun] = {radiance, radiance, radiance};
    std::vector<Channels<double>> exact_light(light.size());
    for (size_t k = 0; k < light.size(); ++k) exact_light[k] = {light[k][0], light[k][1], light[k][2]};
    const auto exact = product_by_entries(t, view(exact_light));
    const auto found = product_by_clusters(find_biclusters(t, {}), view(light));
    double worst = 0, most = 0;
    for (uint32_t j = 0; j < t.rows(); ++j) {
        bool sees_sun = false;
        for (uint32_t i = t.row_begin[j]; i < t.row_begin[j + 1]; ++i) sees_sun |= t.column[i] == sun;
        if (sees_sun) continue;
        worst = std::max(worst, std::abs(static_cast<double>(found[j][0]) - exact[j][0]));
        most = std::max(most, exact[j][0]);
    }
    return worst / most;
}

TEST(TransferProduct, OfASunInTheMapLeaksLittleInFloatsAndNothingInWholeNumbers) {
    const VisibilityTile tile = first_receivers(TowerCity().visibility(64, 16), 200);
    const Transfer t = make_transfer(tile, LocalDirections(8));
    std::vector<Channels<float>> sky(t.columns);
    for (uint32_t k = 0; k < t.columns; ++k) sky[k].fill(0.7F + 0.1F * static_cast<float>(k % 7));
    const uint32_t sun = cell_of(std::array<double, 3>{0.4, 0.3, 0.6}, 16);
    EXPECT_LT(leak(t, sky, sun, 1), 1e-5);
    EXPECT_LT(leak(t, sky, sun, 1e4F), 1e-3);

    sky[sun].fill(1e6F);
    const WholeLight light = whole_light(sky);
    const auto found = product_by_clusters(find_biclusters(t, {}), view(light.values));
    EXPECT_EQ(found, product_by_entries(t, view(light.values)));
    for (uint32_t j = 0; j < t.rows(); ++j) {
        double exact = 0;
        for (uint32_t i = t.row_begin[j]; i < t.row_begin[j + 1]; ++i)
            exact += t.quarters[i] * double{sky[t.column[i]][0]};
        EXPECT_LT(found[j][0], 1u << 31);
        // Half a unit for each quarter that it sees.
        EXPECT_NEAR(found[j][0] * light.unit[0], exact,
                    0.5 * 4 * light.unit[0] * (t.row_begin[j + 1] - t.row_begin[j]) + 1e-12);
    }
}

TEST(TransferProduct, OfNoLightAndOfNothingSeenIsDark) {
    const Transfer t = make_transfer(open_sphere(4, 8), LocalDirections(4));
    const std::vector<Channels<float>> dark(t.columns);
    for (const auto& value : product_by_clusters(find_biclusters(t, {}), view(dark)))
        EXPECT_EQ(value, (Channels<float>{0, 0, 0}));
    VisibilityTile blind{8, {}, {}, {}};
    blind.add_receiver(pack_frame({0, 0, 1}));
    const Transfer none = make_transfer(blind, LocalDirections(4));
    for (const auto& value : product_by_clusters(find_biclusters(none, {}), view(some_light<float>(none.columns, 1))))
        EXPECT_EQ(value, (Channels<float>{0, 0, 0}));
}

TEST(TransferProduct, OfAUniformSkyIsPiOnOpenGround) {
    const LocalDirections local(8);
    const Transfer t = make_transfer(open_ground(32), local);
    const auto light = weighted_light(std::vector<Rgb>(t.columns, Rgb{1, 2, 3}), 32);
    const auto rows = product_by_clusters(find_biclusters(t, {}), view(light));
    const auto found = irradiance(cell_averages(local).cosine, view(rows));
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], (static_cast<double>(c) + 1) * kPi, 0.005 * (static_cast<double>(c) + 1) * kPi);
}

TEST(TransferProduct, OfALossyMatrixStaysWithinItsBoundForEveryLight) {
    const Transfer t = make_transfer(first_receivers(TowerCity().visibility(64, 8), 60), LocalDirections(4));
    for (const uint32_t budget : {2u, 8u, 32u}) {
        const Biclusters lossy = find_biclusters(t, {Seeding::kEntry, 1, budget});
        for (uint64_t seed = 1; seed <= 1000; ++seed) {
            const auto light = some_light<double>(t.columns, seed);
            double brightest = 0;
            for (const auto& value : light) brightest = std::max({brightest, value[0], value[1], value[2]});
            const auto exact = product_by_entries(t, view(light)), found = product_by_clusters(lossy, view(light));
            double worst = 0;
            for (size_t j = 0; j < exact.size(); ++j) {
                for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(exact[j][c] - found[j][c]));
            }
            ASSERT_LE(worst, budget * brightest) << budget << ' ' << seed;
        }
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
