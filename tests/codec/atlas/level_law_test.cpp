#include "codec/atlas/level_law.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "codec/atlas/chart_border.h"

namespace citystream::codec::atlas {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const ViewAxis kThesisView = {1440, 60 * kDegree};

TEST(LevelLaw, GivesTableTwo) {
    const LevelLaw law = thesis_law();
    ASSERT_TRUE(check_law(law).ok());
    const double metres[] = {0.05, 0.4, 3.2};
    const uint32_t mips[] = {2, 2, 0}, borders[] = {2, 2, 0};
    for (uint32_t level = 0; level < 3; ++level) {
        EXPECT_DOUBLE_EQ(law.metres_per_texel(level), metres[level]);
        EXPECT_EQ(law.mips(level), mips[level]);
        EXPECT_EQ(law.border(level), borders[level]);
    }
    EXPECT_EQ(full_tree_nodes(2), 21u);
    EXPECT_EQ(full_tree_nodes(0), 1u);
    EXPECT_EQ(full_tree_nodes(31), (full_tree_nodes(30) - 1) / 4 * 16 + 5);
}

TEST(LevelLaw, CountsMipsForAnyFactor) {
    EXPECT_EQ((LevelLaw{0.05, 2, 5, MipRule::kPaper}).mips(0), 0u);
    EXPECT_EQ((LevelLaw{0.05, 2, 5, MipRule::kFull}).mips(0), 1u);
    EXPECT_EQ((LevelLaw{0.05, 8, 3, MipRule::kFull}).mips(1), 3u);
    EXPECT_EQ((LevelLaw{0.05, 7.99, 3, MipRule::kFull}).mips(1), 2u);
    EXPECT_EQ((LevelLaw{0.05, 1.5, 3, MipRule::kPaper}).mips(0), 0u);
    EXPECT_EQ((LevelLaw{0.05, 256, 3, MipRule::kFull}).mips(0), kMostMips);
    EXPECT_EQ((LevelLaw{0.05, 8, 1, MipRule::kPaper}).mips(0), 0u);
}

TEST(LevelLaw, IsRefusedOutOfRange) {
    EXPECT_FALSE(check_law({0, 8, 3}).ok());
    EXPECT_FALSE(check_law({std::nan(""), 8, 3}).ok());
    EXPECT_FALSE(check_law({0.05, 1, 3}).ok());
    EXPECT_FALSE(check_law({0.05, std::nan(""), 3}).ok());
    EXPECT_FALSE(check_law({0.05, 8, 0}).ok());
    EXPECT_FALSE(check_law({0.05, 8, 17}).ok());
}

TEST(LevelSelection, SwitchesWhereThePapersNumbersSay) {
    EXPECT_NEAR(switch_distance(3.2, kThesisView, 1), 3990.6, 4);
    EXPECT_NEAR(switch_distance(0.4, kThesisView, 1), 498.8, 0.5);
    EXPECT_NEAR(switch_distance(0.05, kThesisView, 1), 62.4, 0.06);
    const LevelLaw law = thesis_law();
    EXPECT_EQ(level_at(law, kThesisView, 3990.6 * 1.001, 1), 2u);
    EXPECT_EQ(level_at(law, kThesisView, 3990.6 * 0.999, 1), 1u);
    EXPECT_EQ(level_at(law, kThesisView, 498.8 * 1.001, 1), 1u);
    EXPECT_EQ(level_at(law, kThesisView, 498.8 * 0.999, 1), 0u);
}

TEST(LevelSelection, FromWithinABoxTakesTheLeaf) {
    EXPECT_EQ(level_at(thesis_law(), kThesisView, 0, 1), 0u);
    EXPECT_EQ(level_at(thesis_law(), kThesisView, -1, 1), 0u);
    EXPECT_EQ(level_at(thesis_law(), kThesisView, std::nan(""), 1), 0u);
    EXPECT_TRUE(std::isinf(screen_projection(1, kThesisView, 0)));
}

TEST(LevelSelection, IsTheSameAlongBothAxesOfOneView) {
    const double vertical = 45 * kDegree;
    const ViewAxis up = {900, vertical}, across = horizontal_axis(1440, 900, vertical);
    for (const double distance : {1.0, 62.4, 500.0, 4000.0}) {
        EXPECT_NEAR(screen_projection(0.4, up, distance), screen_projection(0.4, across, distance), 1e-9);
    }
}

TEST(LevelBlend, IsContinuousOverAllDistances) {
    for (const double factor : {1.5, 2.0, 8.0}) {
        for (const double band : {0.1, 0.3, 1.0}) {
            const LevelLaw law = {0.05, factor, 5, MipRule::kPaper};
            double previous = 0;
            for (double distance = 1; distance < 300000; distance *= 1.0005) {
                const LevelBlend blend = level_blend(law, kThesisView, distance, 1, band);
                EXPECT_EQ(blend.level, level_at(law, kThesisView, distance, 1));
                const double seen = blend.level + blend.coarser;
                ASSERT_GE(seen, previous);
                ASSERT_LT(seen - previous, 0.03) << factor << " " << band << " " << distance;
                previous = seen;
            }
            EXPECT_EQ(previous, 4);
        }
    }
    EXPECT_EQ(level_blend(thesis_law(), kThesisView, 498, 1, 0).coarser, 0);
}

TEST(TerrainResolution, IsAPowerOfTwoInRangeAndNeverRisesWithDistance) {
    for (const double height : {2.0, 50.0, 300.0}) {
        for (const double side : {100.0, 500.0}) {
            uint32_t previous = kFinestTerrain;
            for (double along = 0; along < 20000; along += 10) {
                const uint32_t resolution = terrain_resolution(kThesisView, side, {along, along / 3, -height});
                EXPECT_TRUE(std::has_single_bit(resolution));
                EXPECT_GE(resolution, kCoarsestTerrain);
                EXPECT_LE(resolution, previous);
                previous = resolution;
            }
            EXPECT_EQ(previous, kCoarsestTerrain);
        }
    }
}

TEST(TerrainResolution, ScalesWithTheUnitVectorsVerticalPart) {
    // Seen from straight above at 1000 m, 1 m is 1.247 pixels: a tile of 100 m asks for 124.7, the next power of two.
    EXPECT_EQ(terrain_resolution(kThesisView, 100, {0, 0, -1000}), 128u);
    EXPECT_EQ(terrain_resolution(kThesisView, 100, {866.03, 0, -500}), 64u);
    EXPECT_EQ(terrain_resolution(kThesisView, 100, {1000, 0, 0}), kCoarsestTerrain);
    EXPECT_EQ(terrain_resolution(kThesisView, 100, {0, 0, 0}), kFinestTerrain);
    EXPECT_EQ(terrain_resolution(kThesisView, 1e12, {0, 0, -1}), kFinestTerrain);
}

}  // namespace
}  // namespace citystream::codec::atlas
