#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "client/render/shadow_cascades.h"
#include "client/select/caster_selection.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::Flight;
using test::Layer;
using test::realtime;
using test::SyntheticCity;
using test::TileAddress;

/// In the south, 27 degrees high: shadows of this city's 40 m fall 80 m to the north.
constexpr std::array<double, 3> kLowSun = {0, -0.8944271909999159, 0.4472135954999579};

const SyntheticCity& city() {
    static const SyntheticCity instance;
    return instance;
}

bool is_at_or_above(TileAddress above, TileAddress tile) {
    if (above.level > tile.level) return false;
    const uint32_t levels = tile.level - above.level;
    return tile.x >> levels == above.x && tile.y >> levels == above.y;
}

std::set<TileAddress> addresses(const std::vector<TileDraw>& draws) {
    std::set<TileAddress> all;
    for (const TileDraw& draw : draws) all.insert(draw.address);
    return all;
}

/// Everything of a draw that a picture takes, but for names of layers.
auto picture_of(const TileDraw& draw) {
    return std::tuple(draw.address, draw.mesh_steps, draw.mesh_least_dropped, draw.atlas_finest_mip,
                      draw.facade != kNoLayer, draw.facade_maps.size());
}

void expect_same_pictures(const std::vector<TileDraw>& a, const std::vector<TileDraw>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(picture_of(a[i]), picture_of(b[i]));
}

/// From just within the northern half of the city to the north.
Camera north() {
    return city().camera(530, 520, 15, 0, -10);
}

TEST(Casters, ATowerBehindTheCameraCastsItsShadowIntoTheView) {
    Flight flight(city());
    flight.streamer->set_sun(kLowSun);
    const auto drawn = addresses(flight.update(north()));
    const auto casters = addresses(flight.streamer->casters());
    EXPECT_EQ(flight.frame.caster_tiles, casters.size());
    const auto holds = [](const std::set<TileAddress>& tiles, TileAddress leaf) {
        return std::ranges::any_of(tiles, [&](TileAddress tile) { return is_at_or_above(tile, leaf); });
    };
    // Leaves are 128 m wide: the row before the camera is drawn, the row behind it casts shadows into that.
    EXPECT_TRUE(holds(drawn, {3, 4, 4}));
    EXPECT_FALSE(holds(drawn, {3, 4, 3}));
    EXPECT_TRUE(holds(casters, {3, 4, 3}));
    EXPECT_FALSE(holds(casters, {3, 4, 2})) << "out of the reach of this city's shadows";
}

TEST(Casters, TogetherWithWhatIsDrawnTheyCoverAllThatMayCastAndNothingTwice) {
    size_t all = 0;
    for (const double height : {3.0, 30.0, 200.0}) {
        for (int yaw = 0; yaw < 360; yaw += 40) {
            Flight flight(city());
            flight.streamer->set_sun(kLowSun);
            const Camera camera = city().camera(500, 480, height, yaw, -12);
            const auto drawn = addresses(flight.update(camera));
            const auto casters = addresses(flight.streamer->casters());
            all += casters.size();
            const auto& root = city().tile({}).bounds;
            const CasterVolume volume(camera, {kLowSun, kCascadeEnds.back(), kCasterReach, root.min[2], root.max[2]});
            for (const auto& [address, record] : city().tiles) {
                if (address.level + 1 != city().manifest.levels) continue;
                const auto covers = [leaf = address](TileAddress tile) { return is_at_or_above(tile, leaf); };
                const auto times = std::ranges::count_if(drawn, covers) + std::ranges::count_if(casters, covers);
                EXPECT_LE(times, 1);
                if (volume.meets(record.bounds, city().origin())) {
                    EXPECT_EQ(times, 1) << address.x << " " << address.y;
                }
            }
        }
    }
    EXPECT_GT(all, 30U);
}

TEST(Casters, OnlyTheirMeshesComeAndTheyComeLast) {
    Flight flight(city());
    flight.streamer->set_sun(kLowSun);
    const auto& draws = flight.update(north());
    std::set<std::string> of_view;
    for (const TileDraw& draw : draws) {
        for (const Layer layer : {Layer::kMesh, Layer::kAtlas, Layer::kFacade})
            of_view.insert(layer_path(layer, draw.address));
    }
    std::set<std::string> of_casters;
    for (const TileDraw& draw : flight.streamer->casters()) {
        of_casters.insert(layer_path(Layer::kMesh, draw.address));
        EXPECT_NE(draw.mesh, kNoLayer);
        EXPECT_GT(draw.mesh_steps, 0U);
        EXPECT_FALSE(draw.mesh_ranges.empty());
        EXPECT_EQ(draw.atlas, kNoLayer);
        EXPECT_EQ(draw.facade, kNoLayer);
        EXPECT_EQ(draw.radiance, kNoLayer);
    }
    ASSERT_FALSE(of_casters.empty());
    bool begun = false;
    double least = 1e300;
    for (const FetchRequest& request : flight.fetcher.log) {
        if (!request.path.starts_with("tiles/")) continue;
        const bool caster = of_casters.contains(request.path);
        EXPECT_TRUE(caster || of_view.contains(request.path)) << request.path;
        EXPECT_TRUE(caster || !begun) << request.path << " after casters";
        if (caster) {
            EXPECT_LT(request.priority, least);
        } else {
            least = std::min(least, request.priority);
        }
        begun = begun || caster;
    }
    flight.update(north());
    EXPECT_EQ(flight.frame.requests, 0U);
}

TEST(Casters, WithoutASunOrAtNightNothingIsAskedForAndNothingElseChanges) {
    for (const bool night : {false, true}) {
        Flight plain(city()), flight(city());
        if (night) flight.streamer->set_sun(std::array<double, 3>{0.6, 0, -0.8});
        for (int i = 0; i < 4; ++i) {
            const Camera camera = city().camera(300 + 60 * i, 500, 20, 50 * i, -10);
            expect_same_pictures(plain.update(camera), flight.update(camera));
            EXPECT_TRUE(flight.streamer->casters().empty());
            EXPECT_EQ(plain.frame.wire_bytes, flight.frame.wire_bytes);
            EXPECT_EQ(plain.frame.gpu_bytes_used, flight.frame.gpu_bytes_used);
        }
        EXPECT_EQ(plain.fetcher.log.size(), flight.fetcher.log.size());
    }
    Flight flight(city());
    flight.streamer->set_sun(kLowSun);
    flight.update(north());
    EXPECT_FALSE(flight.streamer->casters().empty());
    flight.streamer->set_sun(std::nullopt);
    flight.update(north());
    EXPECT_TRUE(flight.streamer->casters().empty());
}

TEST(Casters, TheViewIsTheSameWithThem) {
    Flight plain(city()), flight(city());
    flight.streamer->set_sun(kLowSun);
    for (int i = 0; i < 6; ++i) {
        const Camera camera = city().camera(300 + 60 * i, 500, 20, 60 * i, -10);
        expect_same_pictures(plain.update(camera), flight.update(camera));
        EXPECT_EQ(plain.frame.tolerance_used, flight.frame.tolerance_used);
        EXPECT_TRUE(flight.frame.warnings.empty());
    }
}

TEST(Casters, OfflineTheyDependOnTheFrameAloneAndNotOnWhatCameBefore) {
    Flight flown(city());
    flown.fetcher.random_order = true;
    flown.streamer->set_sun(kLowSun);
    for (int i = 0; i < 6; ++i) {
        const Camera camera = city().camera(300 + 60 * i, 500, 20, 60 * i, -10);
        Flight fresh(city());
        fresh.streamer->set_sun(kLowSun);
        fresh.update(camera);
        flown.update(camera);
        expect_same_pictures(fresh.streamer->casters(), flown.streamer->casters());
    }
}

/// A tile that was a caster and then comes into view is what it would have been without.
TEST(Casters, AMeshThatCameWithoutItsAtlasIsDrawnWithIt) {
    Flight flight(city()), fresh(city());
    flight.streamer->set_sun(kLowSun);
    flight.update(north());
    const auto before = addresses(flight.streamer->casters());
    const Camera back = city().camera(530, 520, 15, 180, -10);
    const auto& draws = flight.update(back);
    const auto& expected = fresh.update(back);
    expect_same_pictures(expected, draws);
    size_t turned = 0;
    for (size_t i = 0; i < draws.size(); ++i) {
        if (!before.contains(draws[i].address)) continue;
        ++turned;
        EXPECT_TRUE(std::ranges::equal(flight.store.words_of(draws[i].mesh), fresh.store.words_of(expected[i].mesh)));
        EXPECT_NE(draws[i].atlas, kNoLayer);
    }
    EXPECT_GT(turned, 0U);
}

/// Every mesh names charts that no atlas has: good enough for shadows, not to be drawn.
TEST(Casters, AMeshThatCameWithoutItsAtlasIsNotDrawnUnchecked) {
    test::SyntheticOptions options;
    options.chart_strips = true;
    options.chart_size = 8;
    options.facades = false;
    const SyntheticCity broken(options);
    Flight flight(broken);
    flight.streamer->set_sun(kLowSun);
    size_t casters = 0;
    for (int yaw = 0; yaw < 360; yaw += 60) {
        EXPECT_TRUE(flight.update(broken.camera(530, 520, 15, yaw, -10)).empty()) << yaw;
        casters += flight.frame.caster_tiles;
    }
    EXPECT_GT(casters, 0U);
}

/// The sun is 5 degrees high.
TEST(Casters, BothBudgetsHoldAndTheViewIsServedFirst) {
    for (const bool wait : {true, false}) {
        uint64_t casters = 0, left_out = 0;
        for (const uint64_t gpu : {uint64_t{20} << 10, uint64_t{30} << 10, uint64_t{45} << 10, uint64_t{90} << 10}) {
            StreamerOptions options;
            options.wait_for_selection = wait;
            options.host_budget_bytes = 6U << 20;
            Flight plain(city(), options, gpu, 1024), flight(city(), options, gpu, 1024);
            flight.streamer->set_sun(std::array<double, 3>{0.8, -0.5937171043518958, 0.08717797887081347});
            std::mt19937 random(11);
            std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 200);
            for (int i = 0; i < 12; ++i) {
                const Camera camera = city().camera(place(random), place(random), height(random), turn(random), -15);
                for (int still = 0; still < (wait ? 1 : 8); ++still) {
                    const auto& draws = flight.update(camera);
                    if (wait) {
                        expect_same_pictures(plain.update(camera), draws);
                        EXPECT_EQ(plain.frame.tolerance_used, flight.frame.tolerance_used);
                    }
                    EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
                    EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
                    EXPECT_EQ(flight.store.refused_appends(), 0U);
                    left_out += std::ranges::count_if(flight.frame.warnings, [](const std::string& text) {
                        return text.find("some shadows are missing") != std::string::npos;
                    });
                }
                casters += flight.frame.caster_tiles;
            }
        }
        EXPECT_GT(casters, 0U);
        EXPECT_GT(left_out, 0U) << "the budget was never felt: the test is too easy";
    }
}

TEST(Casters, InRealtimeTheyComeWhenTheViewIsThere) {
    Flight flight(city(), realtime());
    flight.fetcher.per_poll = 2;
    flight.streamer->set_sun(kLowSun);
    uint64_t frames_without = 0, frames_with = 0;
    for (int i = 0; i < 300 && frames_with < 3; ++i) {
        const auto drawn = addresses(flight.update(north()));
        const auto casters = addresses(flight.streamer->casters());
        for (const TileAddress caster : casters) {
            EXPECT_TRUE(std::ranges::none_of(drawn, [&](TileAddress tile) { return is_at_or_above(tile, caster); }));
        }
        if (casters.empty()) ++frames_without;
        if (!casters.empty() && flight.frame.requests == 0 && flight.fetcher.pending() == 0) ++frames_with;
    }
    EXPECT_GT(frames_without, 3U);
    EXPECT_EQ(frames_with, 3U);
    Flight waiting(city());
    waiting.streamer->set_sun(kLowSun);
    waiting.update(north());
    const auto now = addresses(flight.streamer->casters());
    for (const TileAddress caster : addresses(waiting.streamer->casters())) EXPECT_TRUE(now.contains(caster));
}

TEST(Casters, ADamagedMeshOfACasterIsGivenUpAndTheViewStays) {
    Flight plain(city()), flight(city());
    flight.streamer->set_sun(kLowSun);
    flight.fetcher.damage_times["tiles/3/4/3.mesh"] = 1000;
    expect_same_pictures(plain.update(north()), flight.update(north()));
    EXPECT_FALSE(addresses(flight.streamer->casters()).contains(TileAddress{3, 4, 3}));
    ASSERT_EQ(flight.frame.warnings.size(), 1U);
    EXPECT_NE(flight.frame.warnings[0].find("tiles/3/4/3.mesh"), std::string::npos);
    flight.update(north());
    EXPECT_EQ(flight.frame.requests, 0U);
}

}  // namespace
}  // namespace citystream::client
