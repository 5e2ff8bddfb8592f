// Reduction by rows against the resampler's area filter, which holds the whole picture.
#include "tiles/layers/area_reduction.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "codec/atlas/resample.h"
#include "tests/tiles/layers/image_files.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ChartImage;

ChartImage reduced(const ChartImage& image, uint32_t width, uint32_t height) {
    AreaReduction reduction(image.width, image.height, width, height);
    const size_t row = size_t{3} * image.width;
    for (uint32_t y = image.height; y-- > 0;) reduction.add_row(std::span(image.rgb).subspan(y * row, row));
    return reduction.take();
}

TEST(AreaReduction, GivesTheMeanOfEachFootprintInLinearLight) {
    for (const auto& [width, height, out_width, out_height] :
         {std::array{64U, 48U, 16U, 12U}, std::array{61U, 47U, 17U, 13U}, std::array{100U, 1U, 7U, 1U},
          std::array{1U, 100U, 1U, 33U}, std::array{30U, 30U, 30U, 4U}, std::array{50U, 40U, 1U, 1U},
          std::array{20U, 20U, 19U, 19U}}) {
        const ChartImage image{width, height, false, false, 0, noise(size_t{3} * width * height)};
        const ChartImage exact =
            chart_image(resample(linear_image(image), out_width, out_height, codec::atlas::Shrink::kArea));
        const ChartImage found = reduced(image, out_width, out_height);
        ASSERT_EQ(found.width, out_width);
        ASSERT_EQ(found.height, out_height);
        for (size_t i = 0; i < exact.rgb.size(); ++i) ASSERT_LE(std::abs(found.rgb[i] - exact.rgb[i]), 1) << i;
    }
}

TEST(AreaReduction, AnEqualSizeChangesNothing) {
    const ChartImage image{13, 9, false, false, 0, noise(3 * 13 * 9)};
    EXPECT_EQ(reduced(image, 13, 9).rgb, image.rgb);
}

}  // namespace
}  // namespace citystream::tiles::layers
