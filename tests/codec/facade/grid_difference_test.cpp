#include "codec/facade/grid_difference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {
namespace {

/// Any cuts, also ones that nothing needs.
RunGrid random_grid(std::mt19937& random, uint32_t width, uint32_t height) {
    const auto below = [&](uint32_t limit) { return std::uniform_int_distribution<uint32_t>(0, limit - 1)(random); };
    const auto breaks = [&](uint32_t size) {
        std::vector<uint32_t> list = {0};
        while (list.back() < size) list.push_back(std::min(size, list.back() + 1 + below(6)));
        return list;
    };
    RunGrid grid{breaks(width), breaks(height), {}};
    for (uint32_t i = 0; i < grid.columns() * grid.rows(); ++i) {
        const bool open = below(5) == 0;
        grid.labels.push_back(make_label(open ? kOpenDisplacement : static_cast<int32_t>(below(60)) - 30, below(2)));
    }
    return grid;
}

GridDifference by_texel(const RunGrid& a, const RunGrid& b) {
    const FacadeMatrices of_a = expand(a), of_b = expand(b);
    GridDifference found;
    for (size_t i = 0; i < of_a.displacement_mm.size(); ++i) {
        const bool open_a = of_a.displacement_mm[i] == kOpenDisplacement,
                   open_b = of_b.displacement_mm[i] == kOpenDisplacement;
        found.openings |= open_a != open_b;
        if (open_a || open_b) continue;
        found.displacement_mm =
            std::max(found.displacement_mm, std::abs(of_a.displacement_mm[i] - of_b.displacement_mm[i]));
        found.materials |= of_a.material[i] != of_b.material[i];
    }
    return found;
}

TEST(GridDifference, EqualsTheComparisonOfEveryTexel) {
    std::mt19937 random(7);
    for (int i = 0; i < 400; ++i) {
        const auto width = static_cast<uint32_t>(1 + random() % 30), height = static_cast<uint32_t>(1 + random() % 30);
        const RunGrid a = random_grid(random, width, height), b = random_grid(random, width, height);
        const GridDifference fast = difference(a, b), slow = by_texel(a, b);
        EXPECT_EQ(fast.displacement_mm, slow.displacement_mm);
        EXPECT_EQ(fast.materials, slow.materials);
        EXPECT_EQ(fast.openings, slow.openings);
    }
}

TEST(GridDifference, OfOneReliefCutInTwoWaysIsNone) {
    std::mt19937 random(8);
    for (int i = 0; i < 50; ++i) {
        const RunGrid grid = random_grid(random, 40, 25);
        const GridDifference none = difference(grid, merge_equal_runs(grid));
        EXPECT_EQ(none.displacement_mm, 0);
        EXPECT_FALSE(none.materials || none.openings);
    }
}

TEST(GridDifference, OpenTexelsDoNotCountAsDepth) {
    const RunGrid open{{0, 2}, {0, 2}, {make_label(kOpenDisplacement, 0)}}, wall{{0, 2}, {0, 2}, {make_label(5, 1)}};
    const GridDifference found = difference(open, wall);
    EXPECT_TRUE(found.openings);
    EXPECT_FALSE(found.materials);
    EXPECT_EQ(found.displacement_mm, 0);
    // Two open texels are alike whatever their material says.
    const RunGrid other{{0, 2}, {0, 2}, {make_label(kOpenDisplacement, 7)}};
    EXPECT_FALSE(difference(open, other).openings);
}

}  // namespace
}  // namespace citystream::codec::facade
