// Charts by what they hold: pictures of one colour are one texel, equal pictures are there once.
#include "tiles/layers/tile_charts.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST_F(Charts, APictureOfOneColourIsOneTexelWithoutCoordinates) {
    show(chequered(90, 90), 4);
    TileCharts& charts = settle();
    ASSERT_EQ(charts.charts().size(), 1U);
    EXPECT_EQ(charts.charts()[0].width, 1U);
    EXPECT_EQ(charts.charts()[0].height, 1U);
    EXPECT_EQ(charts.charts()[0].rgb, (std::vector<uint8_t>{90, 90, 90}));
    EXPECT_EQ(use(0).scale, (std::array<double, 2>{0, 0}));
    EXPECT_EQ(charts.flat({90, 90, 90}), 0U) << "the same chart as that of the flat colour";
}

TEST_F(Charts, EqualPicturesOfTwoFilesAreOneChart) {
    show(chequered(20, 200), 4);
    show(chequered(20, 200), 8);
    show(chequered(20, 201), 4);
    const TileCharts& charts = settle();
    ASSERT_EQ(charts.charts().size(), 2U);
    EXPECT_EQ(use(0).chart, use(1).chart);
    EXPECT_NE(use(0).chart, use(2).chart);
    EXPECT_EQ(use(1).scale, (std::array<double, 2>{1, 1}));
    const double coarser = 8 / (2.0 * kSide) * std::sqrt(2.0);  // shown twice in u: the mean of both axes
    EXPECT_NEAR(charts.charts()[use(0).chart].metres_per_texel, coarser, 1e-4) << "the error of the coarser use";
}

TEST_F(Charts, EqualPicturesThatWrapDifferentlyStayApart) {
    show(chequered(20, 200), 4, true);
    show(chequered(20, 200), 4, false);
    EXPECT_EQ(settle().charts().size(), 2U);
}

}  // namespace
}  // namespace citystream::tiles::layers
