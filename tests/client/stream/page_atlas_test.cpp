// A city whose atlases are pages, from the choice to the draw: the form is told, a step is a level, damage falls back.
#include <gtest/gtest.h>

#include <algorithm>

#include "codec/atlas/page_layer.h"
#include "tests/client/stream/fake_fetcher.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using codec::atlas::AtlasForm;
using test::draw_of;
using test::Flight;
using test::SyntheticCity;
using test::TileAddress;
using test::whole_view;
using tiles::tileset::Layer;

test::SyntheticOptions with_pages() {
    test::SyntheticOptions options;
    options.pages = true;
    return options;
}

const SyntheticCity& page_city() {
    static const SyntheticCity city(with_pages());
    return city;
}

/// Not in the corner of its parent, where draw_of cannot tell the two.
constexpr TileAddress kTile = {3, 1, 1};
constexpr const char* kAtlasPath = "tiles/3/1/1.atlas";

/// The camera from which leaves are drawn.
Camera near_camera(const SyntheticCity& city) {
    return city.camera(70, 20, 15, 20, -15);
}

TEST(PageAtlas, DrawsTellTheFormOfTheirAtlas) {
    Flight pages(page_city(), whole_view());
    const auto& draws = pages.update(near_camera(page_city()));
    ASSERT_FALSE(draws.empty());
    for (const TileDraw& draw : draws) {
        EXPECT_EQ(draw.atlas_form, AtlasForm::kPages);
        EXPECT_EQ(draw.chart_count, 2u);
        EXPECT_TRUE(draw.shared_charts.empty());
    }
    const SyntheticCity charts;
    Flight flight(charts, whole_view());
    for (const TileDraw& draw : flight.update(near_camera(charts))) EXPECT_EQ(draw.atlas_form, AtlasForm::kCharts);
}

TEST(PageAtlas, EveryStepThatDistanceAsksForIsALevelOfThePages) {
    test::SyntheticOptions options = with_pages();
    options.levels = 1;
    const SyntheticCity city(options);
    const auto& steps = city.tile({0, 0, 0}).steps(Layer::kAtlas);
    ASSERT_EQ(steps.size(), 3u);
    // 415.7 pixels a metre at 1 m: a texel of m metres projects to one pixel 415.7 m metres away.
    for (uint32_t mip = 0; mip < 3; ++mip) {
        for (const double share : {1.05, 1.95}) {
            const double metres = share * 415.7 * static_cast<double>(steps[2 - mip].error);
            Flight flight(city, whole_view());
            const auto& draws = flight.update(city.camera(512, -metres, 8, 0, 0));
            ASSERT_EQ(draws.size(), 1u);
            EXPECT_EQ(draws[0].atlas_finest_mip, mip) << metres << " m";
        }
    }
    Flight flight(city, whole_view());
    EXPECT_EQ(flight.update(city.camera(512, 512, 50, 0, -20)).at(0).atlas_finest_mip, 0u);
}

TEST(PageAtlas, AnAtlasDamagedTwiceIsDrawnFromTheParent) {
    const SyntheticCity& city = page_city();
    Flight flight(city, whole_view());
    flight.fetcher.damage_times[kAtlasPath] = 1000;
    const auto& draws = flight.update(near_camera(city));
    EXPECT_EQ(draw_of(city, draws, kTile), nullptr);
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
    ASSERT_EQ(flight.frame.warnings.size(), 1u);
    EXPECT_NE(flight.frame.warnings[0].find(kAtlasPath), std::string::npos);
}

TEST(PageAtlas, AFinerLevelDamagedTwiceLeavesTheTileCoarser) {
    const SyntheticCity& city = page_city();
    for (uint32_t step = 1; step < 3; ++step) {
        Flight flight(city, whole_view());
        flight.fetcher.damage_times[kAtlasPath] = 1000;
        flight.fetcher.damage_at = city.tile(kTile).steps(Layer::kAtlas)[step - 1].end + 5;
        const TileDraw* draw = draw_of(city, flight.update(near_camera(city)), kTile);
        ASSERT_NE(draw, nullptr);
        EXPECT_EQ(draw->atlas_finest_mip, 3 - step);
        ASSERT_EQ(flight.frame.warnings.size(), 1u);
        EXPECT_NE(flight.frame.warnings[0].find("drawn coarser"), std::string::npos);
    }
}

/// Replaces the steps of a tile's atlas in an archive that is right in everything else.
SyntheticCity city_with_atlas(const std::function<void(LayerSteps&)>& change) {
    test::SyntheticOptions options = with_pages();
    options.change_atlas = {kTile, change};
    return SyntheticCity(options);
}

TEST(PageAtlas, WordsThatTheViewRefusesAreDamageAlthoughTheirChecksumIsRight) {
    const SyntheticCity whole = city_with_atlas([](LayerSteps& steps) { steps[0].words[3] = 9; });
    Flight flight(whole, whole_view());
    EXPECT_EQ(draw_of(whole, flight.update(near_camera(whole)), kTile), nullptr);
    EXPECT_EQ(flight.frame.warnings.size(), 1u);
    const SyntheticCity later = city_with_atlas([](LayerSteps& steps) { steps[2].words.pop_back(); });
    Flight coarser(later, whole_view());
    const TileDraw* draw = draw_of(later, coarser.update(near_camera(later)), kTile);
    ASSERT_NE(draw, nullptr);
    EXPECT_EQ(draw->atlas_finest_mip, 1u) << "the levels before the damaged one are drawn";
}

}  // namespace
}  // namespace citystream::client
