// Shared charts from the choice to the draw: what is fetched and when, what is drawn meanwhile, what happens to damage,
// and that budgets hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "client/cache/directory_pool.h"
#include "tests/client/stream/fake_fetcher.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::draw_of;
using test::Flight;
using test::realtime;
using test::SyntheticCity;
using test::TileAddress;
using test::whole_view;
using tiles::tileset::kChartIndexPath;
using tiles::tileset::kChartLevelsPath;

test::SyntheticOptions with_charts(uint32_t count) {
    test::SyntheticOptions options;
    options.shared_charts = count;
    options.chart_size = 16;
    return options;
}

/// 90 charts in two blocks.
const SyntheticCity& shared_city() {
    static const SyntheticCity city(with_charts(90));
    return city;
}

ChartDictionary dictionary_of(const SyntheticCity& city) {
    ChartDictionary dictionary;
    dictionary.learn(city.charts);
    return dictionary;
}

/// The tile that the cameras below look at; it shows charts 3, 4 and 5, of 1, 2 and 3 levels, with finest texels of
/// 1/64, 2/64 and 3/64 m, and is chosen within 104 m.
constexpr TileAddress kTile = {3, 0, 0};

Camera camera_at(const SyntheticCity& city, double metres) {
    return city.camera(30, -metres, 8, 0, 0);
}

using Levels = std::map<uint32_t, uint32_t>;

/// Levels drawn by number of the chart; 0: its colour.
Levels levels_of(const TileDraw* draw) {
    Levels levels;
    if (draw == nullptr) return levels;
    for (const SharedChartBinding& binding : draw->shared_charts) {
        EXPECT_EQ(binding.layer == kNoLayer, binding.levels == 0);
        levels[binding.chart] = binding.levels;
    }
    return levels;
}

std::vector<FetchRequest> requests_for(const Flight& flight, const std::string& path, size_t first = 0) {
    std::vector<FetchRequest> requests;
    for (size_t i = first; i < flight.fetcher.log.size(); ++i) {
        if (flight.fetcher.log[i].path == path) requests.push_back(flight.fetcher.log[i]);
    }
    return requests;
}

/// How often each byte of the levels entry was asked for.
std::map<uint64_t, int> asked_bytes(const Flight& flight) {
    std::map<uint64_t, int> asked;
    for (const FetchRequest& request : requests_for(flight, kChartLevelsPath)) {
        for (uint64_t byte = request.offset; byte < request.offset + request.length; ++byte) ++asked[byte];
    }
    return asked;
}

TEST(SharedCharts, ACityWithoutDictionaryFetchesMakesAndBindsNothing) {
    const SyntheticCity city;
    Flight flight(city);
    for (int i = 0; i < 6; ++i) {
        for (const TileDraw& draw : flight.update(city.camera(100 + 60 * i, 100, 30, 20 * i, -15))) {
            EXPECT_TRUE(draw.shared_charts.empty());
        }
        EXPECT_EQ(flight.frame.chart_index_bytes + flight.frame.chart_level_bytes + flight.frame.shared_charts, 0u);
    }
    EXPECT_TRUE(requests_for(flight, kChartIndexPath).empty());
    EXPECT_TRUE(requests_for(flight, kChartLevelsPath).empty());
}

TEST(SharedCharts, TilesDrawTheShortestPrefixThatTheirDistanceAllows) {
    const SyntheticCity& city = shared_city();
    // 415.7 pixels a metre at 1 m: a texel of m metres projects to one pixel 415.7 m metres away.
    const std::vector<std::pair<double, Levels>> expected = {
        {90, {{3, 1}, {4, 1}, {5, 1}}}, {79, {{3, 1}, {4, 1}, {5, 1}}}, {77, {{3, 1}, {4, 1}, {5, 2}}},
        {40, {{3, 1}, {4, 1}, {5, 2}}}, {38, {{3, 1}, {4, 1}, {5, 3}}}, {27, {{3, 1}, {4, 1}, {5, 3}}},
        {25, {{3, 1}, {4, 2}, {5, 3}}}, {1, {{3, 1}, {4, 2}, {5, 3}}}};
    Flight flown(city);
    for (const auto& [metres, levels] : expected) {
        Flight flight(city);
        EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, metres)), kTile)), levels) << metres << " m";
        EXPECT_EQ(levels_of(draw_of(city, flown.update(camera_at(city, metres)), kTile)), levels) << metres << " m";
    }
    for (const auto& [metres, levels] : expected) {
        EXPECT_EQ(levels_of(draw_of(city, flown.update(camera_at(city, metres)), kTile)), levels)
            << "what is resident beyond the choice is not drawn";
    }
}

/// Tiles without facades, whose meshes show their charts in strips 32 m wide: charts 3, 4 and 5 of kTile begin at 32,
/// 64 and 96 m.
const SyntheticCity& city_of_strips() {
    static const SyntheticCity city([] {
        test::SyntheticOptions options = with_charts(90);
        options.facades = false;
        options.chart_strips = true;
        return options;
    }());
    return city;
}

TEST(SharedCharts, EachChartOfATileIsAsFineAsItsOwnTrianglesAreNear) {
    const SyntheticCity& city = city_of_strips();
    ASSERT_LT(city.tile(kTile).steps(test::Layer::kMesh)[0].error, 1) << "strips are taken larger by this";
    // Yaw 0 looks north, along the strips. The distances at which levels change are in the test above.
    const std::vector<std::pair<double, Levels>> northward = {
        {-20, {{3, 1}, {4, 1}, {5, 1}}}, {10, {{3, 1}, {4, 1}, {5, 1}}}, {25, {{3, 1}, {4, 1}, {5, 2}}},
        {45, {{3, 1}, {4, 2}, {5, 2}}},  {65, {{3, 1}, {4, 2}, {5, 3}}}, {101, {{3, 1}, {4, 1}, {5, 3}}}};
    Flight flown(city);
    for (const auto& [y, levels] : northward) {
        Flight fresh(city);
        const Camera camera = city.camera(30, y, 8, 0, 0);
        EXPECT_EQ(levels_of(draw_of(city, flown.update(camera), kTile)), levels) << y;
        EXPECT_EQ(levels_of(draw_of(city, fresh.update(camera), kTile)), levels) << y << ", whatever came before";
    }
}

TEST(SharedCharts, WhereTheirTrianglesAreIsKnownBeforeAnyLevelIsAskedForAndWithoutDecoding) {
    const SyntheticCity& city = city_of_strips();
    StreamerOptions counting;
    counting.decode = false;
    counting.directory_pool = std::make_shared<DirectoryPool>();
    Flight drawing(city, whole_view()), loading(city, counting);
    for (const double y : {10.0, 60.0, 100.0}) {
        drawing.update(city.camera(30, y, 8, 0, 0));
        loading.update(city.camera(30, y, 8, 0, 0));
        EXPECT_EQ(drawing.frame.wire_bytes, loading.frame.wire_bytes);
        EXPECT_EQ(drawing.frame.chart_level_bytes, loading.frame.chart_level_bytes);
    }
    bool levels_asked = false;
    for (const FetchRequest& request : drawing.fetcher.log) {
        levels_asked = levels_asked || request.path == kChartLevelsPath;
        const bool of_first_view = request.path == layer_path(test::Layer::kMesh, kTile);
        EXPECT_FALSE(levels_asked && of_first_view && request.offset == 0) << "the mesh comes first";
    }
    EXPECT_TRUE(levels_asked);
}

TEST(SharedCharts, TheWordsInTheStoreAreThoseOfTheLevelsInTheirOrder) {
    const SyntheticCity& city = shared_city();
    for (const bool shuffled : {false, true}) {
        Flight flight(city, shuffled ? realtime() : StreamerOptions());
        flight.fetcher.random_order = shuffled;
        flight.fetcher.per_poll = 2;
        std::set<uint32_t> levels;
        for (int i = 0; i < (shuffled ? 60 : 2); ++i) {
            for (const TileDraw& draw : flight.update(camera_at(city, i % 2 == 0 ? 90 : 20))) {
                for (const SharedChartBinding& binding : draw.shared_charts) {
                    if (binding.layer == kNoLayer) continue;
                    const auto words = flight.store.words_of(binding.layer);
                    std::vector<uint32_t> expected;
                    for (const auto& step : city.steps_of_chart[binding.chart]) {
                        if (expected.size() >= words.size()) break;
                        expected.insert(expected.end(), step.words.begin(), step.words.end());
                    }
                    EXPECT_TRUE(std::ranges::equal(words, expected));
                    EXPECT_EQ(binding.finest_mip + binding.levels, city.steps_of_chart[binding.chart].size());
                    levels.insert(binding.levels);
                }
            }
        }
        EXPECT_EQ(levels.size(), 3u);
    }
}

TEST(SharedCharts, AChartThatManyTilesShowIsFetchedAndHeldOnce) {
    const SyntheticCity city(with_charts(5));  // 85 tiles with three uses each
    for (const bool wait : {true, false}) {
        StreamerOptions options;
        options.wait_for_selection = wait;
        Flight flight(city, options);
        uint64_t uses = 0;
        for (int i = 0; i < 30; ++i) {
            for (const TileDraw& draw : flight.update(city.camera(30 * i, 30 * i, 20, 45, -15))) {
                uses += draw.shared_charts.size();
            }
            EXPECT_LE(flight.frame.shared_charts, 5u);
        }
        EXPECT_GT(uses, 30u * 15);
        EXPECT_EQ(requests_for(flight, kChartIndexPath).size(), 1u);
        for (const auto& [byte, times] : asked_bytes(flight)) ASSERT_EQ(times, 1) << "byte " << byte << " came twice";
    }
}

TEST(SharedCharts, PayloadsThatLieSideBySideAreOneRequest) {
    const SyntheticCity city(with_charts(90));
    Flight flight(city, whole_view());
    flight.update(city.camera(500, 500, 20, 0, -10));
    auto requests = requests_for(flight, kChartLevelsPath);
    ASSERT_GT(requests.size(), 1u);
    std::sort(requests.begin(), requests.end(), [](const auto& a, const auto& b) { return a.offset < b.offset; });
    for (size_t i = 1; i < requests.size(); ++i) {
        EXPECT_GT(requests[i].offset, requests[i - 1].offset + requests[i - 1].length + 256);
    }
    EXPECT_LT(requests.size(), flight.frame.shared_charts);
}

TEST(SharedCharts, WhatAChoiceDependsOnComesBeforeAnyLevelOfAChart) {
    const SyntheticCity& city = shared_city();
    Flight flight(city, whole_view());
    flight.update(camera_at(city, 20));
    size_t last_atlas = 0, index = 0, first_level = 0;
    for (size_t i = 0; i < flight.fetcher.log.size(); ++i) {
        const std::string& path = flight.fetcher.log[i].path;
        if (path.ends_with(".atlas")) last_atlas = i;
        if (path == kChartIndexPath) index = i;
        if (path == kChartLevelsPath && first_level == 0) first_level = i;
    }
    EXPECT_GT(first_level, last_atlas);
    EXPECT_GT(first_level, index);
    EXPECT_GT(index, 0u);
}

TEST(SharedCharts, RefiningFetchesTheFinerLevelsAloneAndDrawsTheCoarserOnesUntilTheyAreHere) {
    const SyntheticCity city(with_charts(6));
    Flight flight(city, realtime());
    const Camera far = city.camera(30, -95, 8, 0, 0), near = city.camera(30, -10, 8, 0, 0);
    for (int i = 0; i < 12; ++i) flight.update(far);
    const auto before = flight.update(far);
    ASSERT_EQ(flight.frame.tiles_missing, 0u);
    Levels coarse;
    for (const TileDraw& draw : before) {
        for (const auto& [chart, levels] : levels_of(&draw)) coarse[chart] = levels;
    }
    flight.fetcher.per_poll = 0;
    for (const TileDraw& draw : flight.update(near)) {
        for (const auto& [chart, levels] : levels_of(&draw)) EXPECT_EQ(levels, coarse.at(chart));
    }
    flight.fetcher.per_poll = 1000;
    for (int i = 0; i < 12; ++i) flight.update(near);
    uint32_t finest = 0;
    for (const TileDraw& draw : flight.update(near)) {
        for (const auto& [chart, levels] : levels_of(&draw)) finest = std::max(finest, levels);
    }
    EXPECT_EQ(finest, 3u);
    for (const auto& [byte, times] : asked_bytes(flight)) ASSERT_EQ(times, 1);
}

/// The first byte behind the checksum of a level.
uint64_t inside(const SyntheticCity& city, uint32_t chart, uint32_t level) {
    return dictionary_of(city).begin(chart_piece(chart, level)) + 6;
}

TEST(SharedCharts, ADamagedLevelIsTriedOnceMoreAndThenTheLevelsBeforeItAreDrawn) {
    const SyntheticCity& city = shared_city();
    for (const bool wait : {true, false}) {
        for (const int times : {1, 1000}) {
            for (const uint32_t level : {0u, 1u, 2u}) {
                StreamerOptions options;
                options.wait_for_selection = wait;
                Flight flight(city, options);
                flight.fetcher.damage_times[kChartLevelsPath] = times;
                flight.fetcher.damage_at = inside(city, 5, level);
                std::vector<std::string> warnings;
                const TileDraw* draw = nullptr;
                for (int i = 0; i < (wait ? 1 : 14); ++i) {
                    draw = draw_of(city, flight.update(camera_at(city, 10)), kTile);
                    warnings.insert(warnings.end(), flight.frame.warnings.begin(), flight.frame.warnings.end());
                }
                ASSERT_NE(draw, nullptr);
                EXPECT_EQ(levels_of(draw), (Levels{{3, 1}, {4, 2}, {5, times == 1 ? 3 : level}}));
                EXPECT_EQ(draw->shared_charts[2].colour, 5u | 20u << 8 | 30u << 16);
                EXPECT_EQ(warnings.size(), times == 1 ? 0u : 1u);
                if (!warnings.empty()) {
                    EXPECT_NE(warnings[0].find("chart 5, level " + std::to_string(level)), std::string::npos)
                        << warnings[0];
                }
                const int asked = asked_bytes(flight).at(flight.fetcher.damage_at);
                EXPECT_EQ(asked, 2);
                flight.update(camera_at(city, 10));
                EXPECT_EQ(flight.frame.requests, 0u);
                EXPECT_TRUE(flight.frame.warnings.empty());
            }
        }
    }
}

/// Bytes with a right checksum and something else than the chart's level in them.
TEST(SharedCharts, APayloadThatIsWholeButNotTheChartIsDamagedToo) {
    SyntheticCity city(with_charts(90));
    auto& entry = city.entries.at(kChartLevelsPath);
    const ChartDictionary dictionary = dictionary_of(city);
    const std::vector<std::byte> frame(dictionary.wire_bytes(chart_piece(5, 2)) - 4, std::byte{7});
    const uint64_t checksum = tiles::tileset::checksum_of(frame.data(), frame.size());
    const uint64_t at = dictionary.begin(chart_piece(5, 2));
    for (size_t i = 0; i < 4; ++i) entry[at + i] = static_cast<std::byte>(checksum >> (8 * i));
    std::copy(frame.begin(), frame.end(), entry.begin() + static_cast<std::ptrdiff_t>(at + 4));
    Flight flight(city);
    const TileDraw* draw = draw_of(city, flight.update(camera_at(city, 10)), kTile);
    EXPECT_EQ(levels_of(draw), (Levels{{3, 1}, {4, 2}, {5, 2}}));
    EXPECT_EQ(flight.frame.warnings.size(), 1u);
    EXPECT_EQ(asked_bytes(flight).at(at), 2);
}

TEST(SharedCharts, AMissingLevelsEntryOrIndexLeavesTilesInColours) {
    const SyntheticCity& city = shared_city();
    for (const char* path : {kChartLevelsPath, kChartIndexPath}) {
        for (const bool damaged : {false, true}) {
            if (damaged && path == std::string(kChartLevelsPath)) continue;
            Flight flight(city);
            (damaged ? flight.fetcher.damage_times : flight.fetcher.missing_times)[path] = 1000;
            const auto& draws = flight.update(camera_at(city, 10));
            EXPECT_FALSE(draws.empty());
            EXPECT_EQ(flight.frame.tiles_missing, 0u);
            for (const TileDraw& draw : draws) {
                EXPECT_EQ(draw.shared_charts.size(), 3u);
                for (const SharedChartBinding& binding : draw.shared_charts) {
                    EXPECT_EQ(binding.layer, kNoLayer);
                    EXPECT_NE(binding.colour, 0u);
                }
            }
            EXPECT_EQ(flight.frame.warnings.size(), 1u);
            EXPECT_EQ(requests_for(flight, kChartIndexPath).size(), damaged ? 2u : 1u);
        }
    }
}

TEST(SharedCharts, HoldBothBudgetsInEveryFrameOfARandomWalk) {
    const SyntheticCity& city = shared_city();
    for (const bool wait : {true, false}) {
        StreamerOptions options = whole_view();
        options.wait_for_selection = wait;
        options.host_budget_bytes = 800u << 10;
        Flight flight(city, options, 180 << 10, 1024);
        flight.fetcher.random_order = true;
        flight.fetcher.per_poll = 5;
        std::mt19937 random(11);
        std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 300);
        double coarsest = 0;
        uint64_t most_host = 0, charts = 0;
        for (int i = 0; i < 100; ++i) {
            const Camera camera = city.camera(place(random), place(random), height(random), turn(random), -20);
            for (int still = 0; still < (wait ? 1 : 4); ++still) {
                flight.update(camera);
                EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
                EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
                EXPECT_EQ(flight.store.refused_appends(), 0u) << "an append was not planned for";
                EXPECT_TRUE(flight.frame.warnings.empty()) << flight.frame.warnings[0];
                coarsest = std::max(coarsest, flight.frame.tolerance_used);
                most_host = std::max(most_host, flight.frame.host_bytes_used);
                charts = std::max(charts, flight.frame.shared_charts);
                if (wait) {
                    EXPECT_EQ(flight.frame.tiles_missing, 0u);
                }
            }
        }
        EXPECT_GT(coarsest, 1.0) << "the GPU budget was never felt: the test is too easy";
        EXPECT_GT(most_host, options.host_budget_bytes * 3 / 4) << "the host budget was never felt";
        EXPECT_GT(charts, 10u);
    }
}

std::set<std::pair<std::array<double, 3>, Levels>> picture_of(const std::vector<TileDraw>& draws) {
    std::set<std::pair<std::array<double, 3>, Levels>> picture;
    for (const TileDraw& draw : draws) picture.insert({draw.origin, levels_of(&draw)});
    return picture;
}

TEST(SharedCharts, OfflineFramesDrawTheSameLevelsWhateverCameBefore) {
    const SyntheticCity& city = shared_city();
    Flight flown(city, {}, 200 << 10, 1024);
    flown.fetcher.random_order = true;
    for (int i = 0; i < 14; ++i) {
        const Camera camera = city.camera(70 * i, 200 - 15 * i, 12, 30 * i, -5);
        const auto picture = picture_of(flown.update(camera));
        Flight fresh(city, {}, 200 << 10, 1024);
        EXPECT_EQ(picture, picture_of(fresh.update(camera))) << "camera " << i;
        EXPECT_EQ(flown.frame.tolerance_used, fresh.frame.tolerance_used);
    }
}

TEST(SharedCharts, AClientThatDoesNotDecodeAsksForTheSameBytes) {
    const SyntheticCity& city = shared_city();
    StreamerOptions counting;
    counting.decode = false;
    counting.directory_pool = std::make_shared<DirectoryPool>();
    Flight drawing(city, whole_view()), loading(city, counting);
    uint64_t levels = 0;
    for (int i = 0; i < 10; ++i) {
        const Camera camera = city.camera(100 + 40 * i, 100, 30, 10 * i, -15);
        const auto drawn = picture_of(drawing.update(camera));
        EXPECT_EQ(drawn, picture_of(loading.update(camera)));
        EXPECT_EQ(drawing.frame.wire_bytes, loading.frame.wire_bytes);
        EXPECT_EQ(drawing.frame.chart_level_bytes, loading.frame.chart_level_bytes);
        EXPECT_EQ(drawing.frame.requests, loading.frame.requests);
        EXPECT_EQ(drawing.frame.gpu_bytes_used, loading.frame.gpu_bytes_used);
        levels += loading.frame.chart_level_bytes;
    }
    EXPECT_GT(levels, 0u);
    EXPECT_EQ(drawing.fetcher.log.size(), loading.fetcher.log.size());
}

TEST(SharedCharts, RealtimeTilesAppearOnlyWithSomethingOfAllTheirCharts) {
    const SyntheticCity& city = shared_city();
    Flight flight(city, realtime());
    flight.fetcher.random_order = true;
    flight.fetcher.per_poll = 1;
    uint64_t drawn = 0;
    for (int i = 0; i < 200; ++i) {
        for (const TileDraw& draw : flight.update(city.camera(512, 100 + i, 20, 0, -10))) {
            EXPECT_EQ(draw.shared_charts.size(), 3u);
            for (const SharedChartBinding& binding : draw.shared_charts) EXPECT_NE(binding.layer, kNoLayer);
            ++drawn;
        }
    }
    EXPECT_GT(drawn, 200u);
}

}  // namespace
}  // namespace citystream::client
