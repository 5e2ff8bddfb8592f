#include "client/render/map_texels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace citystream::client {
namespace {

TEST(MapTexels, KeepChannelsToAFiveHundredthOfTheGreatest) {
    uint64_t state = 7;
    for (int i = 0; i < 20000; ++i) {
        Rgb colour{};
        for (float& channel : colour) {
            state = state * 6364136223846793005ULL + 1442695040888963407ULL;
            channel = std::ldexp(static_cast<float>(state >> 40), static_cast<int>(state >> 20 & 31) - 40);
        }
        const float greatest = std::max({colour[0], colour[1], colour[2]});
        if (greatest >= 32768) continue;
        const Rgb back = unpack_shared_exponent(pack_shared_exponent(colour));
        for (size_t c = 0; c < 3; ++c)
            ASSERT_LE(std::abs(back[c] - colour[c]), std::max(greatest / 512, std::ldexp(1.0F, -25)));
    }
    EXPECT_EQ(pack_shared_exponent({0, 0, 0}), 0U);
    EXPECT_EQ(unpack_shared_exponent(pack_shared_exponent({1, 0.5F, 2}))[2], 2.0F);
}

TEST(MapTexels, TakeMapsThatAreAsBrightAsCanBe) {
    const EnvironmentMap map = {2, 1, {{1e9F, 0, 5e8F}, {1, 1, 1}}};
    const MapTexels texels = map_texels(map);
    EXPECT_NEAR(unpack_shared_exponent(texels.words[0])[0] * texels.scale, 1e9F, 2e6F);
    EXPECT_NEAR(unpack_shared_exponent(texels.words[1])[0] * texels.scale, 1.0F, 0.01F);
    const MapTexels black = map_texels({1, 1, {{0, 0, 0}}});
    EXPECT_EQ(black.words[0], 0U);
}

}  // namespace
}  // namespace citystream::client
