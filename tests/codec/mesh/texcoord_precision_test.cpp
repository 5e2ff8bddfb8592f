#include "codec/mesh/texcoord_precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace citystream::codec::mesh {
namespace {

TEST(TexcoordPrecision, AnImageOf256TexelsNeedsEightBitsAndOneLessAMip) {
    for (uint32_t mip = 0; mip <= 12; ++mip) EXPECT_EQ(texcoord_bits(256, mip, 0), mip < 8 ? 8 - mip : 0);
    EXPECT_EQ(texcoord_bits(1, 0, 0), 0u);
    EXPECT_EQ(texcoord_bits(200, 0, 0), 8u);
    EXPECT_EQ(texcoord_bits(257, 0, 4), 13u);
    EXPECT_EQ(texcoord_bits(65536, 0, 8), 16u);
}

std::vector<std::array<int32_t, 2>> places_on(std::mt19937_64& random, int32_t repeats_u, int32_t repeats_v) {
    std::vector<std::array<int32_t, 2>> places;
    for (int i = 0; i < 500; ++i) {
        places.push_back({static_cast<int32_t>(random() % static_cast<uint64_t>(repeats_u << 16)) - 70000,
                          static_cast<int32_t>(random() % static_cast<uint64_t>(repeats_v << 16)) + 123456});
    }
    return places;
}

TEST(TexcoordPrecision, ErrorIsAtMostHalfTheAllowedPartOfATexelOfTheMipOnShow) {
    std::mt19937_64 random(1);
    for (const auto& [width, height] : {std::pair{256u, 256u}, {1024u, 128u}, {64u, 512u}, {1u, 1u}, {300u, 7u}}) {
        const auto places = places_on(random, 3, 1);
        const TexcoordWords packed = texcoord_words(places, width, height);
        ASSERT_TRUE(check_shape(packed.shape).ok());
        const uint32_t longer = std::max(width, height);
        for (uint32_t mip = 0; mip <= 11; ++mip) {
            constexpr uint32_t kFraction = 3;
            const uint32_t level = texcoord_level(packed, longer, mip, kFraction);
            const auto buffer = pack_precision(packed.shape, packed.words, level);
            const auto view = PrecisionView::create(buffer);
            ASSERT_TRUE(view.ok()) << view.error().text();
            // Texels of the mip along the longer side, as the rule counts them.
            const double texel = 65536.0 / std::exp2(texcoord_bits(longer, mip, 0));
            for (uint32_t v = 0; v < places.size(); ++v) {
                std::array<uint32_t, 2> fetched{};
                view->fetch(v, fetched);
                const auto place = packed.coordinate(fetched, level);
                for (size_t c = 0; c < 2; ++c) {
                    const double scale = std::exp2(packed.shift[c]);
                    ASSERT_LE(std::abs(place[c] - places[v][c]), scale * texel / 8 / 2 + 1);
                }
            }
        }
    }
}

TEST(TexcoordPrecision, AMipLessCostsOneBitAComponentUntilNothingIsLeft) {
    std::mt19937_64 random(2);
    const auto places = places_on(random, 1, 1);
    const TexcoordWords packed = texcoord_words(places, 256, 256);
    uint64_t before = packed.shape.payload_bits(texcoord_level(packed, 256, 0, 0));
    EXPECT_EQ(before, 500u * 2 * 8);
    for (uint32_t mip = 1; mip <= 8; ++mip) {
        const uint64_t bits = packed.shape.payload_bits(texcoord_level(packed, 256, mip, 0));
        EXPECT_EQ(before - bits, 500u * 2);
        before = bits;
    }
    EXPECT_EQ(before, 0u);
}

TEST(TexcoordPrecision, FullLevelGivesCoordinatesOfSquareImagesBack) {
    std::mt19937_64 random(3);
    const auto places = places_on(random, 9, 2);
    const TexcoordWords packed = texcoord_words(places, 512, 512);
    const auto buffer = pack_precision(packed.shape, packed.words, packed.shape.full_bits);
    const auto view = PrecisionView::create(buffer);
    for (uint32_t v = 0; v < places.size(); ++v) {
        std::array<uint32_t, 2> fetched{};
        view->fetch(v, fetched);
        ASSERT_EQ(packed.coordinate(fetched, packed.shape.full_bits), places[v]);
    }
}

TEST(TexcoordPrecision, CoordinatesThatAreAllTheSameTakeNoBits) {
    const std::vector<std::array<int32_t, 2>> places(40, {-5, 77});
    const TexcoordWords packed = texcoord_words(places, 64, 64);
    EXPECT_EQ(packed.shape.payload_bits(packed.shape.full_bits), 0u);
    EXPECT_EQ(packed.coordinate({0, 0}, 0), places[0]);
    EXPECT_TRUE(texcoord_words({}, 64, 64).words.empty());
}

}  // namespace
}  // namespace citystream::codec::mesh
