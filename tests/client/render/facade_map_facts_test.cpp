#include "client/render/facade_map_facts.h"

#include <gtest/gtest.h>

#include "codec/facade/facade_form.h"

namespace citystream::client {
namespace {

using codec::facade::kOpenDisplacement;
using codec::facade::make_label;
using codec::facade::RunGrid;

constexpr uint32_t kWallLabel = make_label(0, 0), kFrame = make_label(-60, 1), kGlass = make_label(-150, 2);

/// 1000 x 100 texels of wall with a strip of another label, `width` texels wide and as high as the wall.
RunGrid wall_with_strip(uint32_t width, uint32_t label = kFrame) {
    return {{0, 500, 500 + width, 1000}, {0, 100}, {kWallLabel, label, kWallLabel}};
}

TEST(FacadeMapFacts, TheFinestRunIsTheNarrowestThatCoversAHundredth) {
    EXPECT_EQ(finest_run(wall_with_strip(11), 0), 11);
    EXPECT_EQ(finest_run(wall_with_strip(40), 0), 40);
    EXPECT_EQ(finest_run(wall_with_strip(10), 0), 490) << "a single sliver does not make all pixels cast more rays";
    EXPECT_EQ(finest_run(wall_with_strip(11), 1), 100);
}

TEST(FacadeMapFacts, RunsAreOfEqualLabelsWhateverTheBreaks) {
    // Breaks that divide nothing, and a bar that only the upper row has.
    const RunGrid grid = {{0, 3, 400, 460, 800},
                          {0, 50, 100},
                          {kWallLabel, kWallLabel, kWallLabel, kWallLabel, kWallLabel, kWallLabel, kGlass, kWallLabel}};
    EXPECT_EQ(finest_run(grid, 0), 60);
    EXPECT_EQ(finest_run(grid, 1), 50);
    const RunGrid plain = {{0, 1, 2, 700}, {0, 9, 300}, std::vector<uint32_t>(6, kWallLabel)};
    EXPECT_EQ(finest_run(plain, 0), 700);
    EXPECT_EQ(finest_run(plain, 1), 300);
}

TEST(FacadeMapFacts, AreReadFromTheWordsOfAMapAndOfNothingElse) {
    for (const uint32_t label : {kFrame, make_label(kOpenDisplacement, 0)}) {
        const auto words = codec::facade::encode_form(codec::facade::FacadeForm::kPatch, wall_with_strip(50, label));
        ASSERT_TRUE(words.ok());
        const FacadeMapFacts facts = facade_map_facts(*words);
        EXPECT_EQ(facts.form, static_cast<uint32_t>(codec::facade::FacadeForm::kPatch));
        EXPECT_EQ(facts.is_opaque, label == kFrame);
        EXPECT_EQ(facts.finest, (std::array<float, 2>{50, 100}));
    }
    const std::vector<uint32_t> other(64, 0x12345678);
    EXPECT_EQ(facade_map_facts(other).form, 0u);
    EXPECT_EQ(facade_map_facts({}).form, 0u);
}

}  // namespace
}  // namespace citystream::client
