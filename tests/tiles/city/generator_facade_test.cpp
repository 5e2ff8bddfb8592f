// The split grammar and the facades derived with it; procedural textures.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "codec/facade/facade_map.h"
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
    const codec::facade::FacadeImage image = canvas.rasterise();
    ASSERT_EQ(image.displacement_mm.size(), 24U);
    ASSERT_EQ(image.material.size(), 24U);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 6; ++x) {
            const bool glass = x >= 3 && y < 2, sill = !glass && x >= 1 && x < 5 && y >= 1 && y < 3;
            const auto at = static_cast<size_t>(y * 6 + x);
            EXPECT_EQ(image.displacement_mm[at], glass ? -20 : sill ? 30 : 0);
            EXPECT_EQ(image.material[at], static_cast<uint8_t>(glass  ? Slot::kGlass
                                                               : sill ? Slot::kSill
                                                                      : Slot::kWall));
        }
    }
}

struct Case {
    FacadeUse use;
    FacadeRole role;
    FacadeSection section;
    uint16_t width_cm;
    uint8_t floors;
};

class DerivedFacade : public testing::TestWithParam<Case> {};

void expect_closed_border(const codec::facade::FacadeImage& image) {
    for (uint32_t x = 0; x < image.width; ++x) {
        ASSERT_GE(image.displacement_mm[x], 0) << "foot, column " << x;
        ASSERT_GE(image.displacement_mm[size_t{image.height - 1} * image.width + x], 0) << "top, column " << x;
    }
    for (uint32_t y = 0; y < image.height; ++y) {
        ASSERT_GE(image.displacement_mm[size_t{y} * image.width], 0) << "left, row " << y;
        ASSERT_GE(image.displacement_mm[size_t{y} * image.width + image.width - 1], 0) << "right, row " << y;
    }
}

TEST_P(DerivedFacade, IsClosedAtItsBorderAndSurvivesTheCodec) {
    const Case& param = GetParam();
    std::set<std::vector<uint32_t>> distinct;
    for (int variant = 0; variant < kFacadeVariants; ++variant) {
        FacadeSpec spec;
        spec.use = param.use;
        spec.role = param.role;
        spec.section = param.section;
        spec.width_cm = param.width_cm;
        spec.floors = param.floors;
        spec.variant = static_cast<uint8_t>(variant);
        spec.shop = variant % 2 == 0;
        const codec::facade::FacadeImage image = derive_facade(spec, 1);
        SCOPED_TRACE("variant " + std::to_string(variant));
        ASSERT_EQ(image.width, param.width_cm);
        ASSERT_EQ(static_cast<int>(image.height),
                  storeys_of(param.use, param.section, variant, param.floors).height_cm());
        EXPECT_EQ(image.height % 25, 0U);
        expect_closed_border(image);
        for (int16_t mm : image.displacement_mm) {
            ASSERT_GE(mm, -250);
            ASSERT_LE(mm, 1200);
        }
        const auto words = codec::facade::encode_facade_map(image);
        ASSERT_TRUE(words) << words.error().text();
        const auto map = codec::facade::FacadeMapView::create(*words);
        ASSERT_TRUE(map);
        std::set<uint32_t> labels;
        for (uint32_t row = 0; row < map->rows(); ++row)
            for (uint32_t column = 0; column < map->columns(); ++column) labels.insert(map->label(column, row));
        EXPECT_LT(labels.size(), 200U);
        EXPECT_GE(labels.size(), 4U) << "a bare wall";
        EXPECT_LE(map->columns(), 260U);
        EXPECT_LE(map->rows(), 200U);
        const auto decoded = codec::facade::decode_facade_map(*words);
        ASSERT_TRUE(decoded);
        EXPECT_TRUE(*decoded == image);
        EXPECT_TRUE(derive_facade(spec, 1) == image) << "not repeatable";
        distinct.insert(*words);
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
