#include "tiles/radiance/height_grid.h"

#include <gtest/gtest.h>

#include "tests/tiles/radiance/box_city.h"
#include "tiles/radiance/horizon_mesh.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;

TEST(HeightGrid, HasTheHighestPointOfEachCellUnderATriangle) {
    HeightGrid grid({-1, -1}, {8, 8});
    // Rises from 0 at x = 0 to 64 m at x = 64.
    grid.add({{at(0, 0, 0), at(64, 0, 64), at(64, 64, 64)}});
    EXPECT_EQ(grid.height({0, 0}), to_grid(16));
    EXPECT_EQ(grid.height({1, 0}), to_grid(32));
    EXPECT_EQ(grid.height({3, 3}), to_grid(64));
    EXPECT_EQ(grid.height({1, 0}), grid.height({1, 1}));
    EXPECT_FALSE(grid.height({0, 2}));  // beyond the triangle's long edge
    EXPECT_FALSE(grid.height({5, 0}));
    EXPECT_FALSE(grid.height({9, 0}));
    EXPECT_FALSE(grid.height({0, -2}));
}

TEST(HeightGrid, KeepsTheHighestOfManyInAnyOrderAndLeavesOutWhatIsOutside) {
    HeightGrid one({0, 0}, {1, 1}, 100), other({0, 0}, {1, 1}, 100);
    const auto low = test::ground(0, 0, 16, 16, 3), high = test::tower(8, 8, 4, 30),
               outside = test::ground(64, 0, 80, 16, 9);
    for (const auto& part : {low, high, outside}) one.add(part);
    for (const auto& part : {outside, high, low}) other.add(part);
    EXPECT_EQ(one.height({0, 0}), to_grid(30));
    EXPECT_EQ(other.height({0, 0}), to_grid(30));
    // The ground's edge is the next cell's, too: it holds its own least coordinates.
    EXPECT_EQ(one.height({1, 0}), to_grid(3));
    EXPECT_EQ(height_cell_of(-1, kHeightCell), (HeightCell{-1, 1}));
}

TEST(HeightGrid, PartsHaveTheSameHeights) {
    HeightGrid grid({0, 0}, {7, 7});
    grid.add(test::city_tile(0, 0, true));
    const HeightGrid part = grid.part({2, 3}, {10, 10});
    for (int64_t y = 0; y < 10; ++y) {
        for (int64_t x = 0; x < 10; ++x) {
            const bool within = x >= 2 && y >= 3;
            EXPECT_EQ(part.height({x, y}), within ? grid.height({x, y}) : std::nullopt);
        }
    }
}

TEST(HorizonMesh, ClosesEveryStepBetweenCells) {
    HeightGrid grid({0, 0}, {2, 0});
    grid.add(test::ground(1, 1, 15, 15, 10));
    grid.add(test::ground(17, 1, 31, 15, 4));
    const HorizonMesh mesh = horizon_mesh(grid, {-5, -5}, {5, 5});
    // Two tops; of the higher cell all four sides, of the lower one three.
    EXPECT_EQ(mesh.triangles.size(), 2 * (2 + 4 + 3));
    int64_t step = 0;
    for (const GridPoint& point : mesh.points) step += point.x == kHeightCell && point.z == to_grid(4) ? 1 : 0;
    EXPECT_GE(step, 2);
    EXPECT_TRUE(horizon_mesh(grid, {3, 3}, {5, 5}).triangles.empty());
}

}  // namespace
}  // namespace citystream::tiles::radiance
