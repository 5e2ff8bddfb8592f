#include "codec/atlas/level_law.h"

#include <gtest/gtest.h>

#include <cmath>

#include "codec/atlas/chart_border.h"

namespace citystream::codec::atlas {
namespace {

TEST(LevelLaw, GivesTableTwo) {
    const LevelLaw law = thesis_law();
    ASSERT_TRUE(check_law(law).ok());
    const double metres[] = {0.05, 0.4, 3.2};
    const uint32_t mips[] = {2, 2, 0}, borders[] = {2, 2, 0};
    for (uint32_t level = 0; level < 3; ++level) {
        EXPECT_DOUBLE_EQ(law.metres_per_texel(level), metres[level]);
        EXPECT_EQ(law.mips(level), mips[level]);
        EXPECT_EQ(border_for_mips(law.mips(level)), borders[level]);
    }
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

}  // namespace
}  // namespace citystream::codec::atlas
