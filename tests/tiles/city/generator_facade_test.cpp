// The split grammar and the facades derived with it; procedural textures.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "codec/facade/run_grid.h"
#include "tiles/city/grammar.h"
#include "tiles/city/grammar_facades.h"
#include "tiles/city/procedural_texture.h"

namespace citystream::tiles::city::procedural {
namespace {

TEST(SplitGrammar, CutsFixedAndFlexiblePartsWithoutGaps) {
    const std::vector<Rect> parts = split_x({10, 0, 111, 50}, {{20, 0}, {0, 2}, {7, 0}, {0, 1}});
    ASSERT_EQ(parts.size(), 4U);
    EXPECT_EQ(parts[0].width(), 20);
    EXPECT_EQ(parts[2].width(), 7);
    EXPECT_EQ(parts.front().x0, 10);
    EXPECT_EQ(parts.back().x1, 111);
    for (size_t i = 1; i < parts.size(); ++i) EXPECT_EQ(parts[i].x0, parts[i - 1].x1);
    EXPECT_NEAR(parts[1].width(), 2 * parts[3].width(), 2);
}

TEST(SplitGrammar, RepeatsEqualPartsNearTheTargetSize) {
    const std::vector<Rect> rows = repeat_y({0, 5, 30, 1005}, 300);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows.front().y0, 5);
    EXPECT_EQ(rows.back().y1, 1005);
    for (const Rect& row : rows) EXPECT_NEAR(row.height(), 333, 1);
    EXPECT_EQ(repeat_x({0, 0, 20, 20}, 300).size(), 1U);
}

TEST(Canvas, ShowsTheLastFillOfEveryTexelAndClipsAtItsBorder) {
    Canvas canvas(6, 4);
    canvas.fill({1, 1, 5, 3}, 30, Slot::kSill);
    canvas.fill({3, -7, 90, 2}, -20, Slot::kGlass);
    const codec::facade::FacadeMatrices image = codec::facade::expand(canvas.relief());
    ASSERT_EQ(image.displacement_mm.size(), 24U);
    ASSERT_EQ(image.material.size(), 24U);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 6; ++x) {
            const bool glass = x >= 3 && y < 2, sill = !glass && x >= 1 && x < 5 && y >= 1 && y < 3;
            const auto at = static_cast<size_t>(y * 6 + x);
            EXPECT_EQ(image.displacement_mm[at], glass ? -20 : sill ? 30 : 0);
            EXPECT_EQ(image.material[at], static_cast<uint16_t>(glass  ? Slot::kGlass
                                                                : sill ? Slot::kSill
                                                                       : Slot::kWall));
        }
    }
}

TEST(Canvas, ItsReliefIsOnTheCoarsestGrid) {
    Canvas canvas(50, 40);
    canvas.fill({10, 10, 30, 20}, 20, Slot::kSill);
    canvas.fill({15, 12, 20, 18}, 20, Slot::kSill);  // shows nothing new
    canvas.fill({40, 0, 45, 40}, 5, Slot::kFrame);
    canvas.fill({35, 0, 50, 40}, 0, Slot::kWall);  // takes everything back
    const codec::facade::RunGrid relief = canvas.relief();
    EXPECT_EQ(relief.x_breaks, (std::vector<uint32_t>{0, 10, 30, 50}));
    EXPECT_EQ(relief.y_breaks, (std::vector<uint32_t>{0, 10, 20, 40}));
    EXPECT_TRUE(codec::facade::is_valid(relief));
}

struct Case {
    FacadeUse use;
    FacadeRole role;
    FacadeSection section;
    uint16_t width_cm;
    uint8_t floors;
};

class DerivedFacade : public testing::TestWithParam<Case> {};

void expect_closed_border(const codec::facade::RunGrid& grid) {
    const auto depth = [&](uint32_t column, uint32_t row) {
        return codec::facade::displacement_of(grid.label(column, row));
    };
    for (uint32_t column = 0; column < grid.columns(); ++column) {
        ASSERT_GE(depth(column, 0), 0) << "foot, column " << column;
        ASSERT_GE(depth(column, grid.rows() - 1), 0) << "top, column " << column;
    }
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        ASSERT_GE(depth(0, row), 0) << "left, row " << row;
        ASSERT_GE(depth(grid.columns() - 1, row), 0) << "right, row " << row;
    }
}

TEST_P(DerivedFacade, IsClosedAtItsBorderAndNeitherBareNorWild) {
    const Case& param = GetParam();
    std::set<std::vector<uint32_t>> distinct;  // runs and labels, one after the other
    for (int variant = 0; variant < kFacadeVariants; ++variant) {
        FacadeSpec spec;
        spec.use = param.use;
        spec.role = param.role;
        spec.section = param.section;
        spec.width_cm = param.width_cm;
        spec.floors = param.floors;
        spec.variant = static_cast<uint8_t>(variant);
        spec.shop = variant % 2 == 0;
        const codec::facade::RunGrid relief = derive_facade(spec, 1);
        SCOPED_TRACE("variant " + std::to_string(variant));
        ASSERT_TRUE(codec::facade::is_valid(relief));
        EXPECT_EQ(codec::facade::merge_equal_runs(relief), relief);
        ASSERT_EQ(relief.width(), param.width_cm);
        ASSERT_EQ(static_cast<int>(relief.height()),
                  storeys_of(param.use, param.section, variant, param.floors).height_cm());
        EXPECT_EQ(relief.height() % 25, 0U);
        expect_closed_border(relief);
        EXPECT_FALSE(relief.has_open_cells());
        EXPECT_GE(relief.depths().min_mm, -250);
        EXPECT_LE(relief.depths().max_mm, 1200);
        const std::set<uint32_t> labels(relief.labels.begin(), relief.labels.end());
        EXPECT_LT(labels.size(), 200U);
        EXPECT_GE(labels.size(), 4U) << "a bare wall";
        for (const uint32_t label : labels) EXPECT_LT(codec::facade::material_of(label), 16U);
        EXPECT_LE(relief.columns(), 260U);
        EXPECT_LE(relief.rows(), 200U);
        EXPECT_EQ(derive_facade(spec, 1), relief) << "not repeatable";
        std::vector<uint32_t> all = relief.x_breaks;
        all.insert(all.end(), relief.y_breaks.begin(), relief.y_breaks.end());
        all.insert(all.end(), relief.labels.begin(), relief.labels.end());
        distinct.insert(std::move(all));
    }
    EXPECT_GE(distinct.size(), param.use == FacadeUse::kGarage ? 1U : 4U) << "variants look alike";
}

INSTANTIATE_TEST_SUITE_P(
    AllUses, DerivedFacade,
    testing::Values(Case{FacadeUse::kHouse, FacadeRole::kFront, FacadeSection::kWhole, 800, 1},
                    Case{FacadeUse::kHouse, FacadeRole::kRear, FacadeSection::kWhole, 1200, 2},
                    Case{FacadeUse::kHouse, FacadeRole::kSide, FacadeSection::kWhole, 900, 2},
                    Case{FacadeUse::kRowHouse, FacadeRole::kFront, FacadeSection::kWhole, 550, 3},
                    Case{FacadeUse::kRowHouse, FacadeRole::kRear, FacadeSection::kWhole, 700, 2},
                    Case{FacadeUse::kRowHouse, FacadeRole::kSide, FacadeSection::kWhole, 1000, 2},
                    Case{FacadeUse::kApartment, FacadeRole::kFront, FacadeSection::kWhole, 1000, 6},
                    Case{FacadeUse::kApartment, FacadeRole::kFront, FacadeSection::kWhole, 2000, 4},
                    Case{FacadeUse::kApartment, FacadeRole::kRear, FacadeSection::kWhole, 1800, 5},
                    Case{FacadeUse::kTower, FacadeRole::kFront, FacadeSection::kBase, 3200, 4},
                    Case{FacadeUse::kTower, FacadeRole::kFront, FacadeSection::kShaft, 1600, 8},
                    Case{FacadeUse::kTower, FacadeRole::kFront, FacadeSection::kTop, 2400, 4},
                    Case{FacadeUse::kHall, FacadeRole::kFront, FacadeSection::kWhole, 2400, 1},
                    Case{FacadeUse::kHall, FacadeRole::kSide, FacadeSection::kWhole, 4000, 1},
                    Case{FacadeUse::kGarage, FacadeRole::kFront, FacadeSection::kWhole, 350, 1}));

/// Mean absolute difference between two columns of texels (or rows).
double seam(const Image& image, uint32_t a, uint32_t b, bool columns) {
    double sum = 0;
    for (uint32_t i = 0; i < image.height; ++i) {
        const size_t pa = columns ? size_t{i} * image.width + a : size_t{a} * image.width + i;
        const size_t pb = columns ? size_t{i} * image.width + b : size_t{b} * image.width + i;
        for (size_t channel = 0; channel < 3; ++channel)
            sum += std::abs(image.rgb[3 * pa + channel] - image.rgb[3 * pb + channel]);
    }
    return sum / image.height;
}

TEST(ProceduralTexture, TilesWithoutASeam) {
    for (const Image& image : {plaster_texture({200, 180, 160}, 12, 5), ground_texture({100, 130, 70}, 34, 20, 6)}) {
        ASSERT_EQ(image.width, static_cast<uint32_t>(kTextureSize));
        for (bool columns : {true, false}) {
            double inside = 0;
            for (uint32_t i = 0; i + 1 < image.width; ++i) inside = std::max(inside, seam(image, i, i + 1, columns));
            EXPECT_LE(seam(image, image.width - 1, 0, columns), inside * 1.2);
        }
    }
}

TEST(ProceduralTexture, DrawsJointsBetweenBricks) {
    const Image image = brick_texture({150, 70, 50}, {180, 170, 160}, 8, 32, 1);
    size_t joints = 0;
    for (size_t i = 0; i < image.rgb.size(); i += 3) joints += image.rgb[i + 2] > 120;
    // One texel in four rows, and one in sixteen columns of the rest.
    EXPECT_NEAR(static_cast<double>(joints) * 3 / static_cast<double>(image.rgb.size()), 0.25 + 0.75 / 16, 0.01);
}

}  // namespace
}  // namespace citystream::tiles::city::procedural
