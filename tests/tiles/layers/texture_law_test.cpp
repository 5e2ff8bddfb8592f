#include "tiles/layers/texture_law.h"

#include <gtest/gtest.h>

#include <array>

namespace citystream::tiles::layers::test {
namespace {

TEST(TextureLaw, WithoutLevelsFollowsTheErrorOfTheGeometry) {
    const TextureLaw law = *parse_texture_law("0.02");
    EXPECT_EQ(law.inner_texel(1, 0.5), 0.25);
    EXPECT_EQ(law.inner_texel(7, 0.5), 0.25) << "whatever the height";
    EXPECT_EQ(law.inner_texel(1, 0.001), 0.02) << "never finer than leaves";
    EXPECT_EQ(parse_texture_law("0.1")->inner_texel(1, 0.01), 0.1);
}

TEST(TextureLaw, TheThesissPresetIsTableTwo) {
    const TextureLaw law = *parse_texture_law("thesis");
    EXPECT_DOUBLE_EQ(law.finest, 0.05);
    EXPECT_DOUBLE_EQ(law.inner_texel(1, 9), 0.4);
    EXPECT_DOUBLE_EQ(law.inner_texel(2, 9), 3.2);
    EXPECT_DOUBLE_EQ(law.inner_texel(5, 9), 3.2) << "taller trees end with the root's";
    const std::array<uint32_t, 4> mips = {law.mips(0), law.mips(1), law.mips(2), law.mips(5)};
    EXPECT_EQ(mips, (std::array<uint32_t, 4>{2, 2, 0, 0}));
    EXPECT_EQ(parse_texture_law("0.05,8,3")->mips(1), 3U) << "as far as the next level's texels";
}

TEST(TextureLaw, IsPrintedAsItIsParsed) {
    for (const char* text : {"thesis", "0.02", "0.05", "0.05,8,3", "0.1,2,16", "0.025,1.5,1"}) {
        const auto law = parse_texture_law(text);
        ASSERT_TRUE(law.ok()) << text;
        EXPECT_EQ(to_string(*law), text);
    }
    EXPECT_EQ(to_string(TextureLaw()), "0.02,4,8");
}

TEST(TextureLaw, WhatIsNoneIsRefusedInOneLine) {
    for (const char* text :
         {"",          "auto",       "auto",        "0",          "-1",       "nan",        "inf",
          "0.0001",    "1e9",        "0.05,8",      "0.05,8,3,1", "0.05,1,3", "0.05,257,3", "0.05,8,0",
          "0.05,8,17", "0.05,8,2.5", "0.05,8,1e30", "0.05,,3",    "0.05,8,",  "0.05 ,8,3",  "0.05,8,3x"}) {
        const auto law = parse_texture_law(text);
        ASSERT_FALSE(law.ok()) << text;
        EXPECT_EQ(law.error().text().find('\n'), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace citystream::tiles::layers::test
