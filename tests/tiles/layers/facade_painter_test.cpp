// Facades seen flat: the picture of a map is the mean of what its texels cover.
#include "tiles/layers/facade_painter.h"

#include <gtest/gtest.h>

#include "tiles/layers/facade_picture.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::make_label;
using codec::facade::RunGrid;

constexpr uint32_t kOpen = make_label(codec::facade::kOpenDisplacement, 1);

/// Windows of 1 m x 1 m, material 1, every 3 m, in a white wall, material 0.
RunGrid windows(uint32_t bays, uint32_t storeys) {
    RunGrid grid{{0}, {0}, {}};
    for (uint32_t i = 0; i < bays; ++i)
        grid.x_breaks.insert(grid.x_breaks.end(), {300 * i + 100, 300 * i + 200, 300 * i + 300});
    for (uint32_t i = 0; i < storeys; ++i)
        grid.y_breaks.insert(grid.y_breaks.end(), {300 * i + 100, 300 * i + 200, 300 * i + 300});
    for (uint32_t y = 0; y < 3 * storeys; ++y) {
        for (uint32_t x = 0; x < 3 * bays; ++x)
            grid.labels.push_back(x % 3 == 1 && y % 3 == 1 ? make_label(-100, 1) : make_label(0, 0));
    }
    return grid;
}

class Painted : public testing::Test {
  protected:
    Painted() {
        catalog_.palettes.emplace_back();
        catalog_.palettes[0].material = {catalog_.add_material({.rgb = {255, 255, 255}}),
                                         catalog_.add_material({.rgb = {0, 0, 0}})};
    }
    std::shared_ptr<const ChartImage> paint(const RunGrid& grid, double texel, double map_texel = 0.01) {
        return painter_.picture(catalog_.facade_maps.add(grid, map_texel), 0, texel);
    }

    city::CityCatalog catalog_;
    ImageCache images_{catalog_, 1 << 20};
    FacadePainter painter_{catalog_, images_, 20000};
};

TEST_F(Painted, TexelsThatFitTheWindowsShowThemAndNothingElse) {
    const auto picture = paint(windows(4, 2), 1);
    ASSERT_EQ(picture->width, 12U);
    ASSERT_EQ(picture->height, 6U);
    EXPECT_FLOAT_EQ(picture->metres_per_texel, 1);
    for (uint32_t y = 0; y < 6; ++y) {
        for (uint32_t x = 0; x < 12; ++x)
            EXPECT_EQ(picture->rgb[3 * (y * 12 + x)], x % 3 == 1 && y % 3 == 1 ? 0 : 255) << x << " " << y;
    }
}

TEST_F(Painted, TexelsAsLargeAsABayAreAllTheirExactMean) {
    // Samples would see windows in some texels and none in others.
    for (const uint32_t bays : {1U, 3U, 7U}) {
        const auto picture = paint(windows(bays, 3), 3);
        for (const uint8_t value : picture->rgb) EXPECT_EQ(value, linear_to_srgb(8.0F / 9));
    }
    EXPECT_EQ(painter_.mean_colour(catalog_.facade_maps.add(windows(3, 3)), 0)[1], linear_to_srgb(8.0F / 9));
}

TEST_F(Painted, PartsOfTexelsCountByTheirArea) {
    const auto picture = paint({{0, 25, 100}, {0, 100}, {make_label(0, 1), make_label(0, 0)}}, 1);
    ASSERT_EQ(picture->rgb.size(), 3U);
    EXPECT_EQ(picture->rgb[0], linear_to_srgb(0.75F));
}

TEST_F(Painted, OpenCellsShowOnlyWhereThereIsNothingElse) {
    const auto picture = paint({{0, 150, 200}, {0, 100}, {kOpen, make_label(0, 0)}}, 1);
    ASSERT_EQ(picture->width, 2U);
    EXPECT_EQ(picture->rgb[0], 0);
    EXPECT_EQ(picture->rgb[3], 255);
}

TEST_F(Painted, TheTexelsLengthOfAMapDecidesHowLargeItsPictureIs) {
    const auto centimetres = paint(windows(2, 1), 1), doubled = paint(windows(3, 1), 1, 0.02);
    EXPECT_EQ(centimetres->width, 6U);
    EXPECT_EQ(doubled->width, 18U);
    EXPECT_DOUBLE_EQ(painter_.facts(catalog_.facade_maps.add(windows(3, 1))).width_metres, 18);
}

TEST_F(Painted, WhatNoLongerFitsTheBudgetIsPaintedAgainTheSame) {
    const auto first = paint(windows(4, 4), 0.25);
    for (uint32_t i = 5; i < 20; ++i) paint(windows(i, 4), 0.25);
    const auto again = paint(windows(4, 4), 0.25);
    EXPECT_NE(first.get(), again.get()) << "16 pictures of 6 kB and more do not fit";
    EXPECT_EQ(first->rgb, again->rgb);
    EXPECT_EQ(again.get(), paint(windows(4, 4), 0.25).get()) << "the latest is kept";
}

}  // namespace
}  // namespace citystream::tiles::layers
