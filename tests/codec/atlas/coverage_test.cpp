#include "codec/atlas/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/codec/atlas/sample_pictures.h"

namespace citystream::codec::atlas {
namespace {

using Corners = std::vector<CoverageVertex>;

Corners quad(double width, double height, double u, double v) {
    return {{{0, 0, 0}, {0, 0}}, {{width, 0, 0}, {u, 0}}, {{width, 0, height}, {u, v}}, {{0, 0, height}, {0, v}}};
}

TEST(Coverage, TheThesissQuadHasRepeatFactor24AndTilesOf12By8) {
    Coverage coverage;
    add_polygon(coverage, quad(48, 48, 4, 6));
    EXPECT_DOUBLE_EQ(coverage.repeats, 24);
    EXPECT_DOUBLE_EQ(coverage.repeats_u, 4);
    EXPECT_DOUBLE_EQ(coverage.repeats_v, 6);
    EXPECT_NEAR(coverage.metres_u, 12, 1e-12);
    EXPECT_NEAR(coverage.metres_v, 8, 1e-12);
}

TEST(Coverage, TwoTrianglesSayWhatTheirQuadSays) {
    const Corners whole = quad(48, 48, 4, 6);
    Coverage coverage;
    add_polygon(coverage, Corners{whole[0], whole[1], whole[2]});
    add_polygon(coverage, Corners{whole[0], whole[2], whole[3]});
    EXPECT_NEAR(coverage.repeats, 24, 1e-12);
    EXPECT_NEAR(coverage.metres_u, 12, 1e-12);
    EXPECT_NEAR(coverage.metres_v, 8, 1e-12);
    EXPECT_EQ(coverage.polygons, 2);
}

TEST(Coverage, TurnedAndMirroredImagesAreMeasuredAlongTheirOwnAxes) {
    Corners turned = quad(48, 24, 4, 6);
    for (auto& corner : turned) corner.texture = {-corner.texture[1], corner.texture[0]};
    Coverage coverage;
    add_polygon(coverage, turned);
    EXPECT_NEAR(coverage.metres_u, 4, 1e-12);   // along the height: 24 m / 6
    EXPECT_NEAR(coverage.metres_v, 12, 1e-12);  // along the width: 48 m / 4
    EXPECT_NEAR(coverage.repeats, 24, 1e-12);
}

TEST(Coverage, TheLargestPatchCountsAndRepeatsAddUp) {
    Coverage a, b;
    add_polygon(a, quad(10, 10, 2, 1));
    add_polygon(b, quad(3, 30, 1, 1.5));
    add_coverage(a, b);
    EXPECT_NEAR(a.metres_u, 5, 1e-12);
    EXPECT_NEAR(a.metres_v, 20, 1e-12);
    EXPECT_NEAR(a.repeats, 3.5, 1e-12);
    EXPECT_EQ(a.polygons, 2);
}

TEST(Coverage, PolygonsWithoutAreaAndBrokenNumbersArePassedOver) {
    // Pitfall 10: nothing divides by their zero spans.
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    Coverage coverage;
    add_polygon(coverage, quad(10, 10, 0, 0));
    add_polygon(coverage, quad(10, 10, 3, 0));
    add_polygon(coverage, quad(0, 10, 1, 1));
    add_polygon(coverage, quad(nan, 10, 1, 1));
    add_polygon(coverage, quad(10, 10, inf, 1));
    add_polygon(coverage, Corners{});
    add_polygon(coverage, Corners{{}, {}});
    EXPECT_FALSE(coverage.used());
    EXPECT_EQ(coverage.degenerate, 7);
    EXPECT_EQ(coverage.metres_u, 0);
    EXPECT_EQ(view_size({512, 512}, coverage, 0.05), (ChartSize{1, 1}));
    add_polygon(coverage, quad(10, 10, 1, 1));
    EXPECT_TRUE(coverage.used());
}

struct ViewCase {
    const char* name;
    ChartSize image;
    double ratios[3];  // printed compression ratios at .05, .4 and 3.2 m, typos as corrected in the notes
};

TEST(ViewSize, The24SizesAndRatiosOfTheThesisAreMatched) {
    const ViewCase cases[] = {
        {"Window", {512, 512}, {2.18, 141.69, 10922.7}},   {"Rocktile", {500, 375}, {1.56, 101.35, 7812.5}},
        {"Bricktile", {499, 366}, {1.52, 98.72, 7609.75}}, {"Fabriktile", {400, 300}, {1, 64.86, 5000}},
        {"Textureatlas", {400, 400}, {1.33, 86.48, 6666}}, {"Crayons", {516, 341}, {1.46, 95.11, 7331}},
        {"Boat", {500, 336}, {1.4, 90.81, 7000}},          {"Aerialphoto", {512, 512}, {2.18, 141.69, 10922}}};
    const double texels[] = {0.05, 0.4, 3.2};
    const ChartSize sizes[] = {{400, 300}, {50, 37}, {6, 4}};
    Coverage coverage;
    add_polygon(coverage, quad(20, 15, 1, 1));
    for (const ViewCase& test : cases) {
        for (size_t i = 0; i < 3; ++i) {
            const ChartSize size = view_size(test.image, coverage, texels[i]);
            EXPECT_EQ(size, sizes[i]) << test.name << " at " << texels[i];
            const double ratio = static_cast<double>(test.image.width) * test.image.height / (size.width * size.height);
            EXPECT_NEAR(ratio, test.ratios[i], 0.01 * test.ratios[i]) << test.name << " at " << texels[i];
        }
    }
}

TEST(ViewSize, NoAxisIsEverEnlarged) {
    sample::Noise noise(1);
    const auto number = [&noise] { return noise() * 256 + noise(); };
    for (int i = 0; i < 10'000; ++i) {
        const ChartSize image{1 + number() % 8192, 1 + number() % 8192};
        Coverage coverage;
        coverage.polygons = 1;
        coverage.metres_u = std::exp2(static_cast<double>(number() % 60) - 30) * number();
        coverage.metres_v = std::exp2(static_cast<double>(number() % 60) - 30) * number();
        const double texel = std::exp2(static_cast<double>(number() % 40) - 20);
        const ChartSize size = view_size(image, coverage, texel);
        ASSERT_GE(size.width, 1);
        ASSERT_GE(size.height, 1);
        ASSERT_LE(size.width, image.width);
        ASSERT_LE(size.height, image.height);
        // No texel is finer than asked for, but for the last one and where the image is coarser.
        if (size.width > 1) {
            ASSERT_LE(size.width, coverage.metres_u / texel * (1 + 1e-6));
        }
        if (size.width < image.width) {
            ASSERT_GT(size.width + 1, coverage.metres_u / texel * (1 - 1e-6));
        }
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
