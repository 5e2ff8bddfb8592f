#include "codec/atlas/facade_tint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "codec/atlas/tint_layout.h"
#include "tests/codec/atlas/rectangle_sets.h"

namespace citystream::codec::atlas {
namespace {

std::vector<Tint> palette_of(size_t count) {
    tests::Dice dice(5);
    std::vector<Tint> palette(count);
    for (Tint& tint : palette) {
        for (float& channel : tint) channel = static_cast<float>(dice.roll(0, 255)) / 255;
    }
    return palette;
}

double difference(const Tint& a, const Tint& b) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(a[c] - b[c]);
    return sum;
}

TEST(FacadeTint, IsContinuousAcrossWholeNumbers) {
    const auto palette = palette_of(24);
    for (double whole = 0; whole < 100; ++whole) {
        for (const double t : {whole + 1 - 5e-5, whole, whole + 0.3})
            EXPECT_LT(difference(tint_at(palette, t + 1e-4), tint_at(palette, t)), 1e-2) << t;
    }
}

TEST(FacadeTint, ShowsEachPaletteColourAtItsNumber) {
    const auto palette = palette_of(24);
    for (size_t i = 0; i < 60; ++i) EXPECT_EQ(tint_at(palette, static_cast<double>(i)), palette[i % 24]);
    EXPECT_LT(difference(tint_at(palette_of(1), 3.7), palette_of(1)[0]), 1e-6);
}

TEST(FacadeTint, ChangesFarFromTheOriginAsSlowlyAsNearIt) {
    const FacadeTint tint{1, 100};
    for (const double far : {0.0, 1e3, 1e6}) {
        for (const std::array<double, 3>& step : {std::array{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}) {
            const double change = tint_place({far + 10 + step[0], far + 10 + step[1], 0}, tint) -
                                  tint_place({far + 10, far + 10, 0}, tint);
            EXPECT_NEAR(change, 0.01, 1e-6) << far;
        }
    }
}

TEST(FacadeTint, OptionsAreParsed) {
    EXPECT_EQ(parse_facade_tint("0")->strength, 0);
    EXPECT_EQ(parse_facade_tint("0.3")->step_metres, 40);
    EXPECT_EQ(parse_facade_tint("0.3,12.5")->step_metres, 12.5);
    for (const char* bad : {"", ",", "x", "0.3,", "-0.1", "1.1", "0.3,0", "0.3,1e6", "0.3,nan", "0.3,5,5", "0.3 "})
        EXPECT_FALSE(parse_facade_tint(bad)) << bad;
}

TEST(FacadeTint, PlacesStayInThePaletteAndGoOnAcrossItsEndsAnywhere) {
    const FacadeTint tint{0.5, 40};
    for (const double x : {-1e7, -960.0, -1e-9, 0.0, 1e-9, 959.999, 960.0, 5e5, 1e7}) {
        for (const double y : {-2e6, 0.0, 5.3e6}) {
            const double place = tint_place({x, y, 7}, tint);
            EXPECT_GE(place, 0) << x << ' ' << y;
            EXPECT_LT(place, TINT_COLOURS) << x << ' ' << y;
            const double beside = tint_place({x + 0.4, y, -7}, tint);
            EXPECT_NEAR(std::remainder(beside - place, TINT_COLOURS), 0.01, 1e-6) << x << ' ' << y;
        }
    }
}

TEST(FacadeTint, ColoursBesideEachOtherAreNear) {
    const auto palette = tint_palette();
    ASSERT_EQ(palette.size(), size_t{TINT_COLOURS});
    for (size_t i = 0; i < palette.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_GE(palette[i][c], 0.4F);
            EXPECT_LE(palette[i][c], 1.0F);
            EXPECT_LT(std::abs(palette[i][c] - palette[(i + 1) % palette.size()][c]), 0.17F) << i;
        }
    }
}

}  // namespace
}  // namespace citystream::codec::atlas
