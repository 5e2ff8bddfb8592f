#include "codec/facade/run_grid.h"

#include <gtest/gtest.h>

#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

/// A cut at every texel.
RunGrid finest_grid(const FacadeMatrices& matrices) {
    RunGrid grid;
    for (uint32_t x = 0; x <= matrices.width; ++x) grid.x_breaks.push_back(x);
    for (uint32_t y = 0; y <= matrices.height; ++y) grid.y_breaks.push_back(y);
    for (size_t i = 0; i < matrices.material.size(); ++i)
        grid.labels.push_back(make_label(matrices.displacement_mm[i], matrices.material[i]));
    return grid;
}

bool columns_differ(const RunGrid& grid, uint32_t a, uint32_t b) {
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        if (grid.label(a, row) != grid.label(b, row)) return true;
    }
    return false;
}

bool rows_differ(const RunGrid& grid, uint32_t a, uint32_t b) {
    for (uint32_t column = 0; column < grid.columns(); ++column) {
        if (grid.label(column, a) != grid.label(column, b)) return true;
    }
    return false;
}

TEST(RunGrid, LabelsKeepDisplacementAndMaterial) {
    for (const int32_t depth : {0, -1, 1, -32768, 32767, -150}) {
        for (const uint32_t material : {0u, 1u, 15u, 65535u}) {
            EXPECT_EQ(displacement_of(make_label(depth, material)), depth);
            EXPECT_EQ(material_of(make_label(depth, material)), material);
        }
    }
}

TEST(RunGrid, ExpandsToTheMatricesItWasMadeOf) {
    for (const ReliefCase& relief : small_reliefs()) {
        const auto grid = make_run_grid(relief.relief);
        ASSERT_TRUE(grid.ok()) << relief.name << ": " << grid.error().text();
        EXPECT_TRUE(is_valid(*grid)) << relief.name;
        EXPECT_EQ(expand(*grid), relief.relief) << relief.name;
    }
}

TEST(RunGrid, CutsOnlyWhereNeighboursDiffer) {
    for (const ReliefCase& relief : small_reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        for (uint32_t c = 1; c < grid.columns(); ++c) EXPECT_TRUE(columns_differ(grid, c - 1, c)) << relief.name;
        for (uint32_t r = 1; r < grid.rows(); ++r) EXPECT_TRUE(rows_differ(grid, r - 1, r)) << relief.name;
    }
}

TEST(RunGrid, MergingTheFinestGridGivesTheCoarsest) {
    for (const ReliefCase& relief : small_reliefs()) {
        const RunGrid coarsest = make_run_grid(relief.relief).value();
        EXPECT_EQ(merge_equal_runs(finest_grid(relief.relief)), coarsest) << relief.name;
        EXPECT_EQ(merge_equal_runs(coarsest), coarsest) << relief.name;
    }
}

TEST(RunGrid, TakesSidesFrom1To8192Only) {
    EXPECT_FALSE(make_run_grid(uniform_relief(0, 5, 0, 0)).ok());
    EXPECT_FALSE(make_run_grid(uniform_relief(5, 0, 0, 0)).ok());
    EXPECT_FALSE(make_run_grid(uniform_relief(8193, 1, 0, 0)).ok());
    EXPECT_FALSE(make_run_grid(uniform_relief(1, 8193, 0, 0)).ok());
    const RunGrid wide = make_run_grid(uniform_relief(8192, 1, -7, 2)).value();
    EXPECT_EQ(wide.x_breaks, (std::vector<uint32_t>{0, 8192}));
    EXPECT_EQ(wide.labels, (std::vector<uint32_t>{make_label(-7, 2)}));
    EXPECT_EQ(make_run_grid(uniform_relief(1, 8192, 0, 0)).value().height(), 8192u);
}

TEST(RunGrid, RefusesMatricesOfAnotherSize) {
    FacadeMatrices ragged = uniform_relief(3, 4, 0, 0);
    ragged.material.pop_back();
    EXPECT_FALSE(make_run_grid(ragged).ok());
    ragged = uniform_relief(3, 4, 0, 0);
    ragged.displacement_mm.push_back(0);
    EXPECT_FALSE(make_run_grid(ragged).ok());
}

TEST(RunGrid, DepthsAreThoseOfCellsThatAreNotOpen) {
    FacadeMatrices relief = uniform_relief(9, 9, 12, 0);
    EXPECT_EQ(make_run_grid(relief)->depths(), (DepthRange{12, 12}));
    EXPECT_FALSE(make_run_grid(relief)->has_open_cells());
    fill_rectangle(relief, 2, 4, 2, 4, -300, 1);
    fill_rectangle(relief, 5, 7, 2, 4, kOpenDisplacement, 1);
    EXPECT_EQ(make_run_grid(relief)->depths(), (DepthRange{-300, 12}));
    EXPECT_TRUE(make_run_grid(relief)->has_open_cells());
    EXPECT_EQ(make_run_grid(uniform_relief(2, 2, -32768, 0))->depths(), (DepthRange{0, 0}));
}

TEST(RunGrid, IsValidNoticesWrongBreaksAndCounts) {
    const RunGrid good = make_run_grid(figure8_relief()).value();
    ASSERT_TRUE(is_valid(good));
    RunGrid bad = good;
    bad.labels.pop_back();
    EXPECT_FALSE(is_valid(bad));
    bad = good;
    bad.x_breaks[1] = bad.x_breaks[2];
    EXPECT_FALSE(is_valid(bad));
    bad = good;
    bad.y_breaks[0] = 1;
    EXPECT_FALSE(is_valid(bad));
    bad = good;
    bad.x_breaks.back() = 8193;
    EXPECT_FALSE(is_valid(bad));
    EXPECT_FALSE(is_valid(RunGrid{{0}, {0}, {}}));
}

}  // namespace
}  // namespace citystream::codec::facade
