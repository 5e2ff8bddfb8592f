// Charts by what they hold: pictures of one colour are that colour, equal pictures are there once.
#include "tiles/layers/tile_charts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "codec/chart_word.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::Paint;
using quadtree::PaintKind;

constexpr uint32_t kSide = 16;

city::Image chequered(uint8_t dark, uint8_t light) {
    city::Image image{kSide, kSide, {}};
    for (uint32_t i = 0; i < kSide * kSide; ++i)
        image.rgb.insert(image.rgb.end(), 3, (i + i / kSide) % 2 == 0 ? dark : light);
    return image;
}

class Charts : public testing::Test {
  protected:
    /// A square of `metres` that shows a picture once.
    void show(const city::Image& image, double metres, bool repeat = true) {
        city::ImageSource source;
        source.pixels = std::make_shared<const city::Image>(image);
        catalog_.images.push_back(source);
        city::Material material;
        material.image = static_cast<int32_t>(catalog_.images.size() - 1);
        material.repeat = repeat;
        const uint32_t index = catalog_.add_material(material);
        quadtree::BuildObject object;
        const auto side = static_cast<int64_t>(metres * kGridUnitsPerMetre);
        object.vertices = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
        object.paints = {{PaintKind::kMaterial, index, 0}};
        constexpr int64_t kOne = 65536;
        object.triangles = {{{0, 1, 2}, {{{0, 0}, {2 * kOne, 0}, {2 * kOne, kOne}}}, 0, {}},
                            {{0, 2, 3}, {{{0, 0}, {2 * kOne, kOne}, {0, kOne}}}, 0, {}}};
        objects_.push_back(object);
    }
    TileCharts& settle() {
        for (uint32_t i = 0; i < objects_.size(); ++i) charts_.note(i, objects_[i]);
        charts_.settle();
        return charts_;
    }
    ChartUse use(uint32_t object) const { return charts_.use(object, objects_[object].paints[0]); }

    city::CityCatalog catalog_;
    ImageCache images_{catalog_, 1 << 20};
    FacadePainter facades_{catalog_, images_, 20000};
    TileCharts charts_{catalog_, images_, facades_, 0.01, 0.1};
    std::vector<quadtree::BuildObject> objects_;
};

TEST_F(Charts, APictureOfOneColourIsThatColourWithoutChartAndCoordinates) {
    show(chequered(90, 90), 4);
    const TileCharts& charts = settle();
    EXPECT_TRUE(charts.own_charts().empty());
    EXPECT_EQ(use(0).chart, 0x805a5a5aU);
    EXPECT_EQ(use(0).scale, (std::array<double, 2>{0, 0}));
}

TEST_F(Charts, TheSizeOfAChartIsThatOfItsFinestMip) {
    show(chequered(20, 200), 4);
    show({4, 2, std::vector<uint8_t>{0, 0, 0, 9, 9, 9, 0, 0, 0, 9, 9, 9, 5, 5, 5, 0, 0, 0, 0, 0, 0, 200, 200, 200}}, 4);
    const TileCharts& charts = settle();
    ASSERT_EQ(charts.own_charts().size(), 2U);
    for (uint32_t object = 0; object < 2; ++object) {
        const auto [width, height] = charts.size_of(use(object).chart);
        EXPECT_EQ(width, charts.own_charts()[use(object).chart].width);
        EXPECT_EQ(height, charts.own_charts()[use(object).chart].height);
    }
    EXPECT_NE(charts.size_of(use(0).chart), charts.size_of(use(1).chart));
    EXPECT_EQ(charts.size_of(codec::colour_word({1, 2, 3})), (std::array<uint32_t, 2>{1, 1}));
    EXPECT_EQ(charts.size_of(2), (std::array<uint32_t, 2>{1, 1}));
}

TEST_F(Charts, APaintOfOneColourNamesIt) {
    quadtree::BuildObject object;
    object.paints = {Paint::flat({1, 2, 3})};
    objects_.push_back(object);
    EXPECT_TRUE(settle().own_charts().empty());
    EXPECT_EQ(use(0).chart, 0x80030201U);
    EXPECT_EQ(use(0).scale, (std::array<double, 2>{0, 0}));
}

TEST_F(Charts, EqualPicturesOfTwoFilesAreOneChart) {
    show(chequered(20, 200), 4);
    show(chequered(20, 200), 8);
    show(chequered(20, 201), 4);
    const TileCharts& charts = settle();
    ASSERT_EQ(charts.own_charts().size(), 2U);
    EXPECT_EQ(use(0).chart, use(1).chart);
    EXPECT_NE(use(0).chart, use(2).chart);
    EXPECT_EQ(use(1).scale, (std::array<double, 2>{1, 1}));
    const double coarser = 8 / (2.0 * kSide) * std::sqrt(2.0);  // shown twice in u: the mean of both axes
    EXPECT_NEAR(charts.own_charts()[use(0).chart].metres_per_texel, coarser, 1e-4) << "the error of the coarser use";
}

TEST_F(Charts, EqualPicturesThatWrapDifferentlyStayApart) {
    show(chequered(20, 200), 4, true);
    show(chequered(20, 200), 4, false);
    EXPECT_EQ(settle().own_charts().size(), 2U);
}

/// A shelf with one chart of every image.
class OneOfEach final : public ChartShelf {
  public:
    std::optional<SharedChart> take(const ChartKey& key, double coarseness, uint64_t texels) override {
        asked_.push_back({key, {0, 1, coarseness, texels}});
        if (!key.is_image()) return std::nullopt;
        return SharedChart{100 + key.name[0], 1, 0};
    }
    const std::vector<CityWishes::Candidate>& asked() const { return asked_; }

  private:
    std::vector<CityWishes::Candidate> asked_;
};

class ShelvedCharts : public Charts {
  protected:
    TileCharts settle_with(ChartShelf& shelf) {
        TileCharts charts(catalog_, images_, facades_, 0.01, 0.1, &shelf);
        for (uint32_t i = 0; i < objects_.size(); ++i) charts.note(i, objects_[i]);
        charts.settle();
        return charts;
    }
};

TEST_F(ShelvedCharts, WhatTheShelfHasIsNamedAndNotMade) {
    show(chequered(20, 200), 4);
    objects_[0].paints.push_back(Paint::flat({1, 2, 3}));
    objects_[0].triangles.push_back(objects_[0].triangles[0]);
    objects_[0].triangles.back().paint = 1;
    OneOfEach shelf;
    const TileCharts charts = settle_with(shelf);
    EXPECT_TRUE(charts.own_charts().empty());
    ASSERT_EQ(charts.shared_charts().size(), 1U);
    const auto& shared = charts.shared_charts()[0];
    EXPECT_EQ(shared.number, 100U);
    const double finest = 4 / (2.0 * kSide) * std::sqrt(2.0);
    EXPECT_NEAR(shared.metres_per_texel, 2 * finest, 1e-4) << "the dictionary has the image halved once";
    EXPECT_NEAR(charts.blur(), 2 * finest, 1e-4);
    const ChartUse use = charts.use(0, objects_[0].paints[0]);
    EXPECT_EQ(use.chart, shared.chart_in_tile);
    EXPECT_EQ(use.scale, (std::array<double, 2>{1, 1})) << "coordinates of the whole image";
    EXPECT_EQ(charts.size_of(use.chart), (std::array<uint32_t, 2>{kSide / 2, kSide / 2}));
    ASSERT_EQ(shelf.asked().size(), 1U);
    EXPECT_EQ(shelf.asked()[0].key.kind, ChartKey::Kind::kRepeatedImage);
    EXPECT_EQ(shelf.asked()[0].demand.coarseness, 0) << "texels of 0.18 m are not halved for 0.01 m";
    EXPECT_EQ(shelf.asked()[0].demand.texels, uint64_t{kSide} * kSide);
}

TEST_F(ShelvedCharts, PartsOfAnImageCountAsWhatWouldBeCutOut) {
    show(chequered(20, 200), 4, false);
    for (auto& triangle : objects_[0].triangles) {
        for (auto& corner : triangle.texcoord) corner[0] = corner[0] / 8;
    }
    OneOfEach shelf;
    const TileCharts charts = settle_with(shelf);
    ASSERT_EQ(shelf.asked().size(), 1U);
    EXPECT_EQ(shelf.asked()[0].key.kind, ChartKey::Kind::kImage);
    EXPECT_EQ(shelf.asked()[0].demand.texels, 5U * kSide) << "a quarter of the width and a texel beside it";
    EXPECT_EQ(charts.use(0, objects_[0].paints[0]).scale, (std::array<double, 2>{1, 1}));
}

TEST_F(ShelvedCharts, PartsOfAnImageThatRepeatsShareItsOneChart) {
    show(chequered(20, 200), 4);
    for (auto& triangle : objects_[0].triangles) {
        for (auto& corner : triangle.texcoord) corner[0] = corner[0] / 8;
    }
    OneOfEach shelf;
    (void)settle_with(shelf);
    ASSERT_EQ(shelf.asked().size(), 1U);
    EXPECT_EQ(shelf.asked()[0].key.kind, ChartKey::Kind::kRepeatedImage)
        << "where others show it repeated, it is there";
    EXPECT_EQ(shelf.asked()[0].demand.texels, 5U * kSide) << "still only what would be cut out";
}

TEST_F(ShelvedCharts, TwoUsesOfOneSharedChartAreOneEntryWithTheCoarserTexel) {
    show(chequered(20, 200), 4);
    show(chequered(20, 200), 8);
    for (auto& material : catalog_.materials) material.image = 0;
    objects_[1].paints[0].a = objects_[0].paints[0].a;
    catalog_.materials.push_back(catalog_.materials[0]);
    catalog_.materials.back().rgb = {9, 9, 9};
    objects_[1].paints[0].a = static_cast<uint32_t>(catalog_.materials.size() - 1);
    OneOfEach shelf;
    const TileCharts charts = settle_with(shelf);
    ASSERT_EQ(charts.shared_charts().size(), 1U);
    EXPECT_NEAR(charts.shared_charts()[0].metres_per_texel, 2 * 8 / (2.0 * kSide) * std::sqrt(2.0), 1e-4);
    EXPECT_EQ(charts.use(0, objects_[0].paints[0]).chart, charts.use(1, objects_[1].paints[0]).chart);
}

}  // namespace
}  // namespace citystream::tiles::layers
