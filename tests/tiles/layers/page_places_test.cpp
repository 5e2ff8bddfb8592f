#include "tiles/layers/page_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace citystream::tiles::layers {
namespace {

codec::atlas::ChartImage chart_of(uint32_t side, bool repeats) {
    codec::atlas::ChartImage chart;
    chart.width = chart.height = side;
    chart.repeat_u = chart.repeat_v = repeats;
    return chart;
}

std::vector<ChartPlaceOfCorner> fitted(std::vector<ChartPlaceOfCorner> corners, const codec::atlas::ChartImage& chart) {
    fit_page_places(corners, chart);
    return corners;
}

TEST(PagePlaces, MoveByHalfAStepAtMostAndAlikeInEveryPolygon) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(0, 60);
    const auto chart = chart_of(64, true);
    for (int i = 0; i < 1000; ++i) {
        const std::vector<ChartPlaceOfCorner> corners = {{place(random), place(random)},
                                                         {place(random), place(random)}};
        const auto moved = fitted(corners, chart);
        EXPECT_EQ(fitted({corners[1]}, chart)[0], moved[1]);
        for (size_t corner = 0; corner < 2; ++corner) {
            for (size_t axis = 0; axis < 2; ++axis) {
                EXPECT_LE(std::abs(moved[corner][axis] - corners[corner][axis]), 1.0 / 1024);
                EXPECT_EQ(moved[corner][axis] * 512, std::round(moved[corner][axis] * 512));
            }
        }
    }
}

TEST(PagePlaces, LeaveWholeRepeatsOutOnlyWhereTheyMust) {
    const auto chart = chart_of(64, true);
    EXPECT_EQ(fitted({{5.5, 3.25}, {63.5, 3.75}}, chart), (std::vector<ChartPlaceOfCorner>{{5.5, 3.25}, {63.5, 3.75}}));
    EXPECT_EQ(fitted({{-2.5, 80.25}, {4.5, 81.25}}, chart),
              (std::vector<ChartPlaceOfCorner>{{0.5, 0.25}, {7.5, 1.25}}));
}

TEST(PagePlaces, KeepAPolygonOf64RepeatsWhereItIs) {
    EXPECT_EQ(fitted({{-1.5, 0}, {62.5, 1}}, chart_of(64, true)),
              (std::vector<ChartPlaceOfCorner>{{-1.5, 0}, {62.5, 1}}));
}

TEST(PagePlaces, OfAnAxisThatDoesNotRepeatEndAtTheFirstTexel) {
    // Half a texel is 16/512 repeat; farther out the mapping would change.
    const auto moved = fitted({{-16.0 / 512, -17.0 / 512}, {1, 1.5}}, chart_of(16, false));
    EXPECT_EQ(moved, (std::vector<ChartPlaceOfCorner>{{0, -17.0 / 512}, {1, 1.5}}));
}

}  // namespace
}  // namespace citystream::tiles::layers
