// What biclusters of spheres and of cities cost, against the paper's figures (Sun et al. 2011, Table 2 and section 7.2)
// and those of a prototype of it.
#include <gtest/gtest.h>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/local_directions.h"
#include "tests/bench/radiance_samples.h"
#include "tests/codec/radiance/radiance_scenes.h"

namespace citystream::bench {
namespace {

using codec::radiance::Biclusters;
using codec::radiance::LocalDirections;
using codec::radiance::Seeding;
using codec::radiance::Transfer;
using codec::radiance::VisibilityTile;

constexpr uint32_t kTexelsAcross = 32;

/// FLOPs in percent of 2 nnz of all rows, and the bytes of 4 for each number that the paper's sizes imply.
struct Cost {
    double percent = 0, bytes = 0;
};

Cost cost_of(const Transfer& transfer, const Biclusters& clusters) {
    const auto numbers = static_cast<double>(clusters.row.size() + 2 * clusters.column.size());
    return {100 * static_cast<double>(clusters.flops()) / static_cast<double>(transfer.flops()), 4 * numbers};
}

Cost cost_of(const VisibilityTile& tile, uint32_t local_side = 8) {
    const Transfer transfer = make_transfer(tile, LocalDirections(local_side));
    return cost_of(transfer, find_biclusters(transfer, {Seeding::kEntry, 1, 0}));
}

TEST(RadianceFigures, TowersAlongTheAxesTakeATwelfthOfTheWork) {
    // A tile of 128 m, 25 towers 16 m wide, eight neighbours, a lattice of 4 m along the towers' edges. The prototype
    // had 1,034 bytes a receiver.
    const VisibilityTile tile = codec::radiance::TowerCity().visibility(4, kTexelsAcross);
    const Cost cost = cost_of(tile);
    EXPECT_LE(cost.percent, 8);
    EXPECT_LE(cost.bytes, 1.3 * 1034 * tile.receivers());
}

TEST(RadianceFigures, TowersEachTurnedTakeASeventhOfTheWork) {
    SampleOptions options;
    options.lattice_metres = 8;
    const auto sample = bake_box_city(true, options);
    ASSERT_TRUE(sample.ok()) << sample.error().text();
    const Cost cost = cost_of(sample->visibility);
    EXPECT_LE(cost.percent, 15);
    EXPECT_LE(cost.bytes, 1.3 * 2089 * sample->visibility.receivers());
}

TEST(RadianceFigures, DistinctRowsOfTheBoxCityTakeATwelfthOfTheWork) {
    SampleOptions options;
    options.lattice_metres = 8;
    const auto sample = bake_box_city(false, options);
    ASSERT_TRUE(sample.ok()) << sample.error().text();
    const Transfer all = make_transfer(sample->visibility, LocalDirections(8));
    const Transfer rows = distinct_rows(all).rows;
    EXPECT_LE(cost_of(all, find_biclusters(rows, {Seeding::kEntry, 1, 0})).percent, 8);
}

TEST(RadianceFigures, AnOpenSphereTakesAThirdOfTheWorkAndGrowsSlowlyWithDirections) {
    const VisibilityTile sphere = open_sphere(500, kTexelsAcross).visibility;
    const Cost coarse = cost_of(sphere, 8), fine = cost_of(sphere, 16), finest = cost_of(sphere, 32);
    EXPECT_LE(coarse.percent, 32);
    EXPECT_LE(fine.bytes, 1.7 * coarse.bytes);
    EXPECT_LE(finest.bytes, 2.5 * coarse.bytes);
}

}  // namespace
}  // namespace citystream::bench
