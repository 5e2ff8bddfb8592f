// Lone samples become like those around them, within a stated error, and the layer takes fewer bytes for it.
#include "codec/radiance/visibility_smoothing.h"

#include <gtest/gtest.h>

#include <numbers>

#include "codec/radiance/radiance_layer.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

constexpr uint32_t kSide = 16;

RadianceTile city() {
    return LatticeScene::towers(32, 2, 7).tile(32, 12, kSide);
}

/// Hemispheres of samples that differ, of each receiver.
std::vector<double> differences(const VisibilityTile& a, const VisibilityTile& b) {
    std::vector<double> wrong(a.receivers(), 0);
    for (uint32_t r = 0; r < a.receivers(); ++r) {
        for (uint32_t s = 0; s < sample_count(a.side); ++s) {
            if (a.sees(r, s) != b.sees(r, s))
                wrong[r] += cell_solid_angle(kSamplesAcross * a.side, s) / (2 * std::numbers::pi);
        }
    }
    return wrong;
}

TEST(VisibilitySmoothing, LeavesNoReceiverMoreWrongThanItSays) {
    const VisibilityTile exact = city().visibility;
    for (const double bound : {0.001, 0.01, 0.05}) {
        VisibilityTile smooth = exact;
        const double said = smooth_visibility(smooth, bound);
        const auto wrong = differences(exact, smooth);
        EXPECT_LE(said, bound);
        EXPECT_NEAR(*std::max_element(wrong.begin(), wrong.end()), said, 1e-12);
        EXPECT_GT(said, 0);
    }
    VisibilityTile same = exact;
    EXPECT_EQ(smooth_visibility(same, 0), 0);
    EXPECT_EQ(smooth_visibility(same, -1), 0);
    EXPECT_EQ(same, exact);
}

TEST(VisibilitySmoothing, OfAReceiverDoesNotDependOnTheOthers) {
    const VisibilityTile exact = city().visibility;
    VisibilityTile all = exact, first = first_receivers(exact, 20);
    smooth_visibility(all, 0.004);
    smooth_visibility(first, 0.004);
    EXPECT_EQ(first_receivers(all, 20).words, first.words);
}

TEST(VisibilitySmoothing, MakesEvenOnlySquaresWithOneLoneSampleAboveThePlane) {
    VisibilityTile tile{4, {}, {}, {}};
    tile.add_receiver(pack_frame({0, 0, 1}));
    const uint32_t across = kSamplesAcross * tile.side, top = 4 * across * across;
    for (const uint32_t s :
         {top, top + 2, top + 3, top + 4, top + across + 4, top + across + 5, across * across / 2 + 1})
        tile.set(0, s);
    VisibilityTile smooth = tile;
    smooth_visibility(smooth, 1);
    EXPECT_FALSE(smooth.sees(0, top)) << "one of four";
    EXPECT_TRUE(smooth.sees(0, top + 2) && smooth.sees(0, top + 3)) << "two of four";
    EXPECT_TRUE(smooth.sees(0, top + 5)) << "three of four";
}

TEST(VisibilitySmoothing, TakesFewerBytesTheGreaterTheErrorWhichTheStepsState) {
    uint64_t bytes = ~uint64_t{0};
    double error = -1;
    for (const double bound : {0.0, 0.005, 0.02}) {
        RadianceTile tile = city();
        const double said = smooth_visibility(tile.visibility, bound);
        const auto steps = encode_radiance_layer(tile, 4, 1, said);
        ASSERT_TRUE(steps.ok());
        uint64_t taken = 0;
        for (const RadianceLayerStep& step : *steps) taken += step.wire.size();
        EXPECT_LT(taken, bytes);
        EXPECT_EQ(steps->back().error, static_cast<float>(said));
        EXPECT_GE((*steps)[0].error, (*steps)[1].error);
        EXPECT_GT(said, error);
        bytes = taken;
        error = said;
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
