#include "codec/mesh/constrained_precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "codec/mesh/binned_buffer.h"

namespace citystream::codec::mesh {
namespace {

TEST(ConstrainedPrecision, SlopeOfTextureCoordinatesAlongAWallIsTheirRepeatsAMetre) {
    // 2 repeats along 1,000 units, 3 along 500 upwards; however the corners are turned.
    const std::array<GridPoint, 3> wall = {{{0, 0, 0}, {1000, 0, 0}, {0, 0, 500}}};
    const std::vector<double> places = {0, 0, 2, 0, 0, 3};
    for (size_t turn = 0; turn < 3; ++turn) {
        std::array<GridPoint, 3> corners{};
        std::vector<double> values;
        for (size_t i = 0; i < 3; ++i) {
            corners[i] = wall[(i + turn) % 3];
            values.push_back(places[2 * ((i + turn) % 3)]);
            values.push_back(places[2 * ((i + turn) % 3) + 1]);
        }
        EXPECT_NEAR(attribute_slope(corners, values), 3.0 / 500, 1e-12);
    }
}

TEST(ConstrainedPrecision, SlopeBoundsTheChangeOfAttributesForEveryMovementInThePlane) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    double tightest = 0;
    for (int i = 0; i < 2000; ++i) {
        std::array<GridPoint, 3> corners{};
        for (GridPoint& corner : corners)
            for (int32_t& x : corner) x = static_cast<int32_t>(random() % 20000) - 10000;
        std::vector<double> normals;
        for (int k = 0; k < 9; ++k) normals.push_back(unit(random));
        const double slope = attribute_slope(corners, normals);
        for (int move = 0; move < 50; ++move) {
            // A movement by barycentric weights (s, t) from the first corner.
            const double s = unit(random), t = unit(random);
            double moved = 0, changed = 0;
            for (size_t c = 0; c < 3; ++c) {
                const double step = s * (corners[1][c] - corners[0][c]) + t * (corners[2][c] - corners[0][c]);
                const double change = s * (normals[3 + c] - normals[c]) + t * (normals[6 + c] - normals[c]);
                moved += step * step;
                changed += change * change;
            }
            ASSERT_LE(std::sqrt(changed), slope * std::sqrt(moved) * (1 + 1e-9));
            tightest = std::max(tightest, std::sqrt(changed) / (slope * std::sqrt(moved)));
        }
    }
    EXPECT_GT(tightest, 0.999);
}

TEST(ConstrainedPrecision, FlatShadedFacesAskForNothingAndTrianglesWithoutAreaForEverything) {
    const std::vector<double> flat = {0, 0, 1, 0, 0, 1, 0, 0, 1}, bent = {0, 0, 1, 0, 0, 1, 1, 0, 0};
    const std::array<GridPoint, 3> triangle = {{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}}};
    const std::array<GridPoint, 3> line = {{{0, 0, 0}, {5, 5, 5}, {9, 9, 9}}}, point = {};
    for (const auto& corners : {triangle, line, point}) EXPECT_EQ(attribute_slope(corners, flat), 0);
    for (const auto& corners : {line, point})
        EXPECT_EQ(attribute_slope(corners, bent), std::numeric_limits<double>::infinity());
    const std::vector<GridPoint> points = {line[0], line[1], line[2]};
    const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}};
    EXPECT_EQ(constrained_dropped(points, triangles, std::vector<AttributeLimit>{{bent}}, {}, 12),
              (std::vector<uint32_t>{0, 0, 0}));
    EXPECT_EQ(constrained_dropped(points, triangles, std::vector<AttributeLimit>{{flat}}, {}, 12),
              (std::vector<uint32_t>{12, 12, 12}));
}

TEST(ConstrainedPrecision, NeedlesAskForMoreBitsThanWideTriangles) {
    const std::vector<double> bent = {0, 0, 1, 0, 0, 1, 1, 0, 0};
    double before = 0;
    for (int32_t height = 4096; height >= 1; height /= 2) {
        const double slope = attribute_slope({{{0, 0, 0}, {8192, 0, 0}, {4096, height, 0}}}, bent);
        EXPECT_TRUE(std::isfinite(slope));
        EXPECT_GT(slope, before);
        before = slope;
    }
}

TEST(ConstrainedPrecision, OneRepeatOf256TexelsNeedsEightBits) {
    // Notes: E_t = 1 (one repeat along the whole extent), 256 x 256 texels: at least 8 bits for a change of one texel.
    constexpr int32_t kExtent = 1 << 20;
    const std::vector<GridPoint> points = {{0, 0, 0}, {kExtent, 0, 0}, {0, kExtent, 0}};
    const std::vector<double> places = {0, 0, 1, 0, 0, 1};
    const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}};
    const AttributeLimit limit{places, 2, 1, texture_slope(256, 64)};
    const auto dropped = constrained_dropped(points, triangles, std::vector<AttributeLimit>{limit}, {}, 20);
    for (const uint32_t d : dropped) EXPECT_EQ(20 - d, 8u);
}

TEST(ConstrainedPrecision, AVertexTakesTheFinestOfItsTrianglesAndDuplicatesAgree) {
    // Two triangles with a corner in common by place, one flat, one strongly bent.
    const std::vector<GridPoint> points = {{0, 0, 0}, {4000, 0, 0}, {0, 4000, 0}, {0, 0, 0}, {-50, 0, 0}, {0, -50, 0}};
    const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}, {3, 4, 5}};
    const std::vector<double> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0};
    const auto dropped =
        constrained_dropped(points, triangles, std::vector<AttributeLimit>{{normals, 3, 1, 1}}, {}, 12);
    EXPECT_EQ(dropped[1], 12u);
    EXPECT_EQ(dropped[2], 12u);
    EXPECT_LT(dropped[3], 12u);
    EXPECT_EQ(dropped[0], dropped[3]);
    // slope sqrt(3) / 50 or so: 2^4 = 16 < 28.9 < 32
    EXPECT_EQ(dropped[3], 4u);
    const std::vector<uint8_t> border = {1, 0, 0, 1, 0, 0};
    const auto at_border =
        constrained_dropped(points, triangles, std::vector<AttributeLimit>{{normals, 3, 1, 1}}, border, 12);
    EXPECT_EQ(at_border, (std::vector<uint32_t>{12, 12, 12, 12, 4, 4}));
}

TEST(ConstrainedPrecision, SeveralAttributesTogetherAskForTheFinestOfThem) {
    const std::vector<GridPoint> points = {{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}};
    const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}};
    const std::vector<double> normals = {0, 0, 1, .1, 0, 1, 0, .1, 1}, places = {0, 0, 4, 0, 0, 4};
    const AttributeLimit shading{normals, 3, 0.01, 1}, texture{places, 2, 1, 64};
    const auto both = constrained_dropped(points, triangles, std::vector<AttributeLimit>{shading, texture}, {}, 12);
    const auto one = constrained_dropped(points, triangles, std::vector<AttributeLimit>{shading}, {}, 12);
    const auto other = constrained_dropped(points, triangles, std::vector<AttributeLimit>{texture}, {}, 12);
    for (size_t v = 0; v < 3; ++v) EXPECT_EQ(both[v], std::min(one[v], other[v]));
    EXPECT_EQ(blinn_slope(31), 32);
}

}  // namespace
}  // namespace citystream::codec::mesh
