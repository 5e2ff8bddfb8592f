// The catalog of facade maps: each distinct relief once, back as it was.
#include "tiles/city/facade_catalog.h"

#include <gtest/gtest.h>

#include <random>

namespace citystream::tiles::city {
namespace {

using codec::facade::make_label;
using codec::facade::RunGrid;

RunGrid random_grid(std::mt19937& random, uint32_t columns, uint32_t rows, uint32_t labels) {
    const auto below = [&](uint32_t limit) { return std::uniform_int_distribution<uint32_t>(0, limit - 1)(random); };
    RunGrid grid{{0}, {0}, {}};
    for (uint32_t i = 0; i < columns; ++i) grid.x_breaks.push_back(grid.x_breaks.back() + 1 + below(20));
    for (uint32_t i = 0; i < rows; ++i) grid.y_breaks.push_back(grid.y_breaks.back() + 1 + below(20));
    for (uint32_t i = 0; i < columns * rows; ++i)
        grid.labels.push_back(make_label(static_cast<int32_t>(below(labels)) - 100, below(16)));
    return grid;
}

TEST(FacadeCatalog, OfEqualMapsTheLeastTexelLengthCounts) {
    std::mt19937 random(4);
    FacadeCatalog catalog;
    const RunGrid grid = random_grid(random, 5, 4, 3), other = random_grid(random, 6, 4, 3);
    EXPECT_EQ(catalog.texel_metres(catalog.add(other)), 0.01);
    const uint32_t map = catalog.add(grid, 0.004);
    EXPECT_EQ(catalog.add(grid, 0.002), map);
    EXPECT_EQ(catalog.add(grid, 0.008), map);
    EXPECT_EQ(catalog.texel_metres(map), 0.002);
    EXPECT_EQ(catalog.size(), 2U);
}

TEST(FacadeCatalog, GivesEveryMapBackOnItsCoarsestGrid) {
    std::mt19937 random(1);
    FacadeCatalog catalog;
    std::vector<RunGrid> grids;
    for (const uint32_t labels : {1U, 2U, 30U, 2000U}) {
        for (int i = 0; i < 20; ++i) {
            const auto side = [&] { return 1 + static_cast<uint32_t>(random() % 30); };
            const uint32_t columns = side(), rows = side();
            grids.push_back(random_grid(random, columns, rows, labels));
        }
    }
    std::vector<uint32_t> index;
    for (const RunGrid& grid : grids) index.push_back(catalog.add(grid));
    for (size_t i = 0; i < grids.size(); ++i)
        EXPECT_EQ(catalog.map(index[i]), codec::facade::merge_equal_runs(grids[i])) << i;
}

TEST(FacadeCatalog, EqualReliefHasOneIndexHoweverItIsCut) {
    FacadeCatalog catalog;
    const uint32_t wall = make_label(0, 0), glass = make_label(-80, 3);
    const RunGrid coarse{{0, 100, 300}, {0, 200}, {wall, glass}};
    const RunGrid cut{{0, 40, 100, 170, 300}, {0, 1, 200}, {wall, wall, glass, glass, wall, wall, glass, glass}};
    const RunGrid other{{0, 101, 300}, {0, 200}, {wall, glass}};
    EXPECT_EQ(catalog.add(coarse), 0U);
    EXPECT_EQ(catalog.add(other), 1U);
    const uint64_t bytes = catalog.memory_bytes();
    EXPECT_EQ(catalog.add(cut), 0U);
    EXPECT_EQ(catalog.size(), 2U);
    EXPECT_EQ(catalog.memory_bytes(), bytes);
    EXPECT_FALSE(catalog.empty());
}

TEST(FacadeCatalog, KeepsTheGreatestSidesDepthsAndSlots) {
    FacadeCatalog catalog;
    const RunGrid grid{{0, 8191, 8192},
                       {0, 8192},
                       {make_label(codec::facade::kOpenDisplacement, 0), make_label(INT16_MAX, UINT16_MAX)}};
    EXPECT_EQ(catalog.map(catalog.add(grid)), grid);
}

TEST(FacadeCatalog, AThousandUnlikeMapsStayFarBelowTheirTexels) {
    std::mt19937 random(2);
    FacadeCatalog catalog;
    for (int i = 0; i < 1000; ++i) catalog.add(random_grid(random, 40, 40, 4));
    EXPECT_EQ(catalog.size(), 1000U);
    EXPECT_LT(catalog.memory_bytes(), 1000U * 2500U);
}

}  // namespace
}  // namespace citystream::tiles::city
