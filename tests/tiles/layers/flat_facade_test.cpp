// The rectangles that stand in for facades without relief.
#include "tiles/layers/flat_facade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace citystream::tiles::layers {
namespace {

using codec::facade::make_label;
using codec::facade::RunGrid;

constexpr uint32_t kOpen = make_label(codec::facade::kOpenDisplacement, 0);
constexpr double kTexel = 0.01;  // metres

/// 10 m x 8 m: a wall of 5 m with a gable above it, in steps of `step` cm.
RunGrid gable(uint32_t step) {
    RunGrid grid{{0}, {0, 500}, {}};
    for (uint32_t x = step; x <= 1000; x += step) grid.x_breaks.push_back(x);
    for (uint32_t y = 500 + step; y <= 800; y += step) grid.y_breaks.push_back(y);
    if (grid.y_breaks.back() != 800) grid.y_breaks.push_back(800);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const double x = 0.5 * (grid.x_breaks[column] + grid.x_breaks[column + 1]),
                         y = 0.5 * (grid.y_breaks[row] + grid.y_breaks[row + 1]);
            const bool wall = y < 500 || (y - 500) / 300 < 1 - std::abs(x - 500) / 500;
            grid.labels.push_back(wall ? make_label(column % 2 == 0 ? 20 : -30, column % 3) : kOpen);
        }
    }
    return grid;
}

double area(const FacadePanels& flat) {
    double sum = 0;
    for (const FacadePanel& panel : flat.panels)
        sum += (panel.hi[0] - panel.lo[0]) / 65536.0 * ((panel.hi[1] - panel.lo[1]) / 65536.0);
    return sum;
}

TEST(FlatPanels, AMapWithoutOpenCellsIsOneExactPanel) {
    const FacadePanels flat = flat_panels({{0, 100, 300}, {0, 200}, {make_label(5, 1), make_label(-90, 2)}}, kTexel);
    EXPECT_EQ(flat.panels, (std::vector<FacadePanel>{{{0, 0}, {65536, 65536}}}));
    EXPECT_EQ(flat.error_metres, 0);
}

TEST(FlatPanels, AGableIsAFewPanelsThatCoverAboutItsArea) {
    const FacadePanels flat = flat_panels(gable(10), kTexel);
    EXPECT_GE(flat.panels.size(), 3U);
    EXPECT_LE(flat.panels.size(), 8U);
    EXPECT_GT(flat.error_metres, 0.08);
    EXPECT_LE(flat.error_metres, 1.28);
    EXPECT_NEAR(area(flat) * 80, 50 + 15, 5);
    for (size_t i = 0; i < flat.panels.size(); ++i) {
        for (size_t k = 0; k < i; ++k) {
            const FacadePanel &a = flat.panels[i], &b = flat.panels[k];
            const bool apart = a.lo[0] >= b.hi[0] || b.lo[0] >= a.hi[0] || a.lo[1] >= b.hi[1] || b.lo[1] >= a.hi[1];
            EXPECT_TRUE(apart) << "panels " << i << " and " << k << " lie over each other";
        }
    }
}

TEST(FlatPanels, PanelsAreOfTheSameSizeOnTheWallWhateverTheTexels) {
    RunGrid fine = gable(10);
    for (auto* breaks : {&fine.x_breaks, &fine.y_breaks}) {
        for (uint32_t& at : *breaks) at *= 5;
    }
    const FacadePanels coarse = flat_panels(gable(10), kTexel), same = flat_panels(fine, kTexel / 5);
    EXPECT_EQ(same.panels, coarse.panels);
    EXPECT_NEAR(same.error_metres, coarse.error_metres, 1e-9);
}

TEST(FlatPanels, AMapOfOpenCellsOnlyHasNone) {
    EXPECT_TRUE(flat_panels({{0, 100}, {0, 200}, {kOpen}}, kTexel).panels.empty());
}

TEST(FlatPanels, AGatewayStaysOpen) {
    const uint32_t wall = make_label(0, 0);
    const FacadePanels flat =
        flat_panels({{0, 400, 800, 1200}, {0, 400, 1000}, {wall, kOpen, wall, wall, wall, wall}}, kTexel);
    EXPECT_EQ(flat.panels.size(), 3U);
    EXPECT_NEAR(area(flat), 1 - 0.4 / 3, 1e-3);
}

TEST(FlatQuad, TheWholePanelHasTheCornersOfTheFacade) {
    std::mt19937 random(2);
    for (int i = 0; i < 100; ++i) {
        quadtree::BuildFacade facade;
        const auto any = [&] { return static_cast<int32_t>(random() % 200001) - 100000; };
        facade.origin = {any(), any(), any()};
        facade.along = {any(), any()};
        facade.height = static_cast<uint32_t>(random() % 50000);
        const FlatQuad quad = flat_quad(facade, {{0, 0}, {65536, 65536}});
        EXPECT_EQ(quad.corners, facade.corners());
        EXPECT_EQ(quad.texcoords[2], (std::array<int64_t, 2>{65536, 65536}));
    }
}

TEST(FlatQuad, PanelsThatMeetShareTheirPoints) {
    quadtree::BuildFacade facade;
    facade.along = {-7777, 3331};
    facade.height = 9999;
    const FlatQuad left = flat_quad(facade, {{0, 0}, {21845, 30000}}),
                   right = flat_quad(facade, {{21845, 0}, {65536, 30000}}),
                   above = flat_quad(facade, {{0, 30000}, {21845, 65536}});
    EXPECT_EQ(left.corners[1], right.corners[0]);
    EXPECT_EQ(left.corners[2], right.corners[3]);
    EXPECT_EQ(left.corners[3], above.corners[0]);
    EXPECT_EQ(left.corners[2], above.corners[1]);
}

}  // namespace
}  // namespace citystream::tiles::layers
