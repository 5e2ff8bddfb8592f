// Levels of facade maps from the choice to the draw: what is fetched, what is drawn meanwhile, what happens to damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "codec/facade/raw_map.h"
#include "tests/client/stream/fake_fetcher.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::draw_of;
using test::Flight;
using test::Layer;
using test::realtime;
using test::SyntheticCity;
using test::TileAddress;
using tiles::tileset::kFacadeIndexPath;
using tiles::tileset::kFacadeMapsPath;

const SyntheticCity& shared_city() {
    static const SyntheticCity city;
    return city;
}

/// What a client knows of the city's dictionary.
FacadeDictionary dictionary_of(const SyntheticCity& city) {
    FacadeDictionary dictionary;
    dictionary.learn(city.maps);
    return dictionary;
}

/// The tile that the cameras below look at; it uses maps 0, 1 and 2, with 1, 2 and 3 levels.
constexpr TileAddress kTile = {3, 0, 0};

/// In front of kTile, so many metres from its bounds and from the wall of map 0; those of maps 1 and 2 stand 4 and 8 m
/// behind it. At 640 x 480 its relief shows within 62 m; texels of 12 cm are fine enough beyond 50 m, of 4 cm beyond
/// 16.7 m.
Camera camera_at(const SyntheticCity& city, double metres) {
    return city.camera(30, -metres, 8, 0, 0);
}

using Levels = std::map<uint32_t, uint32_t>;

/// Level by map of a draw; nothing when the tile is flat.
Levels levels_of(const TileDraw* draw) {
    Levels levels;
    if (draw == nullptr || draw->facade == kNoLayer) return levels;
    for (const FacadeMapBinding& binding : draw->facade_maps) levels[binding.map] = binding.level;
    return levels;
}

/// Requests to the maps entry since the log had `first` entries.
std::vector<FetchRequest> map_requests(const Flight& flight, size_t first = 0) {
    std::vector<FetchRequest> requests;
    for (size_t i = first; i < flight.fetcher.log.size(); ++i) {
        if (flight.fetcher.log[i].path == kFacadeMapsPath) requests.push_back(flight.fetcher.log[i]);
    }
    return requests;
}

bool asks_for(const std::vector<FetchRequest>& requests, const FacadeDictionary& dictionary, MapPiece piece) {
    return std::any_of(requests.begin(), requests.end(), [&](const FetchRequest& request) {
        return request.offset <= dictionary.begin(piece) &&
               request.offset + request.length >= dictionary.record_of(piece).end;
    });
}

TEST(FacadeMaps, FacadesDrawTheCoarsestLevelThatTheirOwnDistanceAllows) {
    const SyntheticCity& city = shared_city();
    const std::vector<std::pair<double, Levels>> expected = {{70, {}},
                                                             {55, {{0, 0}, {1, 0}, {2, 0}}},
                                                             {43, {{0, 0}, {1, 0}, {2, 0}}},
                                                             {41, {{0, 0}, {1, 0}, {2, 1}}},
                                                             {13, {{0, 0}, {1, 0}, {2, 1}}},
                                                             {12, {{0, 0}, {1, 1}, {2, 1}}},
                                                             {8, {{0, 0}, {1, 1}, {2, 2}}}};
    for (const auto& [metres, levels] : expected) {
        Flight flight(city);
        EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, metres)), kTile)), levels) << metres << " m";
    }
}

TEST(FacadeMaps, TheWordsInTheStoreAreThoseOfTheLevel) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    std::set<uint32_t> levels;
    for (const double metres : {30.0, 8.0}) {
        for (const TileDraw& draw : flight.update(camera_at(city, metres))) {
            for (const FacadeMapBinding& binding : draw.facade_maps) {
                const auto words = flight.store.words_of(binding.layer);
                EXPECT_TRUE(std::ranges::equal(words, city.words_of_piece.at(map_piece(binding.map, binding.level))));
                levels.insert(binding.level);
            }
        }
    }
    EXPECT_EQ(levels.size(), 3u);
}

TEST(FacadeMaps, AForcedLevelHoldsAtEveryDistance) {
    const SyntheticCity& city = shared_city();
    for (const uint32_t level : {0u, 1u, 3u}) {
        StreamerOptions options;
        options.relief.map_level = level;
        Flight flight(city, options);
        for (const double metres : {55.0, 10.0}) {
            const Levels expected = {{0, 0}, {1, std::min(level, 1u)}, {2, std::min(level, 2u)}};
            EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, metres)), kTile)), expected);
        }
    }
}

TEST(FacadeMaps, RefiningFetchesTheFinerLevelAloneAndDrawsTheCoarserOneUntilItIsHere) {
    test::SyntheticOptions rough;
    rough.rough_maps = true;  // too far apart to come along with their neighbours
    const SyntheticCity city(rough);
    const FacadeDictionary dictionary = dictionary_of(city);
    Flight flight(city, realtime());
    for (int i = 0; i < 8; ++i) flight.update(camera_at(city, 55));
    const Levels coarse = {{0, 0}, {1, 0}, {2, 0}}, fine = {{0, 0}, {1, 1}, {2, 2}};
    ASSERT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, 55)), kTile)), coarse);

    const size_t before = flight.fetcher.log.size();
    flight.fetcher.per_poll = 0;
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, 8)), kTile)), coarse);
    }
    const auto requests = map_requests(flight, before);
    EXPECT_TRUE(asks_for(requests, dictionary, map_piece(1, 1)));
    EXPECT_TRUE(asks_for(requests, dictionary, map_piece(2, 2)));
    for (const MapPiece here : {map_piece(0, 0), map_piece(1, 0), map_piece(2, 0)}) {
        EXPECT_FALSE(asks_for(requests, dictionary, here));
    }
    EXPECT_FALSE(asks_for(requests, dictionary, map_piece(2, 1))) << "the level between is of no use";

    flight.fetcher.per_poll = 1000;
    for (int i = 0; i < 4; ++i) flight.update(camera_at(city, 8));
    EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, 8)), kTile)), fine);
}

TEST(FacadeMaps, WaveringAtAThresholdFetchesEachLevelOnce) {
    const SyntheticCity& city = shared_city();
    for (const bool wait : {true, false}) {
        StreamerOptions options;
        options.wait_for_selection = wait;
        Flight flight(city, options);
        for (int i = 0; i < 40; ++i) flight.update(camera_at(city, i % 2 == 0 ? 8 : 10));
        std::set<uint64_t> seen;
        for (const FetchRequest& request : map_requests(flight)) {
            for (uint64_t byte = request.offset; byte < request.offset + request.length; ++byte) {
                EXPECT_TRUE(seen.insert(byte).second) << "a byte of the maps came twice";
            }
        }
        EXPECT_FALSE(seen.empty());
        const size_t settled = flight.fetcher.log.size();
        uint64_t decoded = 0;
        for (int i = 0; i < 10; ++i) {
            flight.update(camera_at(city, i % 2 == 0 ? 8 : 10));
            decoded += flight.frame.decoded_bytes;
        }
        EXPECT_EQ(flight.fetcher.log.size(), settled);
        EXPECT_EQ(decoded, 0u) << "both levels stay in the store";
    }
}

TEST(FacadeMaps, LevelsThatLieSideBySideOrAlmostAreOneRequest) {
    const SyntheticCity& city = shared_city();
    for (const auto& level : {std::optional<uint32_t>(3), std::optional<uint32_t>(0)}) {
        StreamerOptions options;
        options.relief.map_level = level;
        Flight flight(city, options);
        flight.update(camera_at(city, 8));
        const auto requests = map_requests(flight);
        ASSERT_FALSE(requests.empty());
        for (size_t i = 1; i < requests.size(); ++i) {
            std::vector<FetchRequest> sorted = requests;
            std::sort(sorted.begin(), sorted.end(),
                      [](const FetchRequest& a, const FetchRequest& b) { return a.offset < b.offset; });
            EXPECT_GT(sorted[i].offset - (sorted[i - 1].offset + sorted[i - 1].length), 256u);
        }
    }
}

TEST(FacadeMaps, ADamagedLevelIsTriedOnceMoreAndThenTheNextCoarserOneIsDrawn) {
    const SyntheticCity& city = shared_city();
    const FacadeDictionary dictionary = dictionary_of(city);
    const Levels fine = {{0, 0}, {1, 1}, {2, 2}}, coarser = {{0, 0}, {1, 1}, {2, 1}};
    for (const int times : {1, 1000}) {
        Flight flight(city);
        flight.fetcher.damage_times[kFacadeMapsPath] = times;
        flight.fetcher.damage_at = dictionary.begin(map_piece(2, 2)) + 3;
        EXPECT_EQ(levels_of(draw_of(city, flight.update(camera_at(city, 8)), kTile)), times == 1 ? fine : coarser);
        EXPECT_EQ(flight.frame.warnings.size(), times == 1 ? 0u : 1u);
        if (times > 1) {
            EXPECT_NE(flight.frame.warnings[0].find("map 2, level 2"), std::string::npos) << flight.frame.warnings[0];
        }
        flight.update(camera_at(city, 8));
        EXPECT_TRUE(flight.frame.warnings.empty());
        EXPECT_EQ(flight.frame.requests, 0u);
    }
}

TEST(FacadeMaps, AMapWithoutAnyLevelLeavesItsTilesFlat) {
    const SyntheticCity& city = shared_city();
    for (const bool wait : {true, false}) {
        StreamerOptions options;
        options.wait_for_selection = wait;
        Flight flight(city, options);
        flight.fetcher.damage_times[kFacadeMapsPath] = 1000;
        flight.fetcher.damage_at = 0;  // of map 0, which has one level
        std::vector<std::string> warnings;
        const std::vector<TileDraw>* draws = nullptr;
        for (int i = 0; i < 12; ++i) {
            draws = &flight.update(city.camera(100, -10, 10, 0, 0));
            warnings.insert(warnings.end(), flight.frame.warnings.begin(), flight.frame.warnings.end());
        }
        const TileDraw* tile = draw_of(city, *draws, kTile);
        ASSERT_NE(tile, nullptr);
        EXPECT_EQ(tile->facade, kNoLayer);
        EXPECT_GT(flight.frame.relief_tiles, 0u) << "other tiles keep their relief";
        EXPECT_GT(flight.frame.flat_tiles, 0u);
        ASSERT_EQ(warnings.size(), 1u);
        EXPECT_NE(warnings[0].find("drawn flat"), std::string::npos) << warnings[0];
    }
}

TEST(FacadeMaps, AMissingMapsEntryLeavesFacadesFlatUntilItIsBack) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    flight.fetcher.missing_times[kFacadeMapsPath] = 1000;
    flight.update(camera_at(city, 8));
    EXPECT_EQ(flight.frame.relief_tiles, 0u);
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
    EXPECT_FALSE(flight.frame.warnings.empty());
}

/// All that a picture depends on: place and levels of every draw.
std::set<std::pair<std::array<double, 3>, Levels>> picture_of(const std::vector<TileDraw>& draws) {
    std::set<std::pair<std::array<double, 3>, Levels>> picture;
    for (const TileDraw& draw : draws) picture.insert({draw.origin, levels_of(&draw)});
    return picture;
}

TEST(FacadeMaps, OfflineFramesDrawTheSameLevelsWhateverCameBefore) {
    const SyntheticCity& city = shared_city();
    for (const auto& form : {std::optional<codec::facade::FacadeForm>(),
                             std::optional<codec::facade::FacadeForm>(codec::facade::FacadeForm::kRaw)}) {
        StreamerOptions options;
        options.facade_form = form;
        Flight flown(city, options, 100 << 10, 1024);
        for (int i = 0; i < 12; ++i) {
            const Camera camera = city.camera(80 * i, 200 - 15 * i, 12, 30 * i, -5);
            const auto picture = picture_of(flown.update(camera));
            Flight fresh(city, options, 100 << 10, 1024);
            EXPECT_EQ(picture, picture_of(fresh.update(camera))) << "camera " << i;
            EXPECT_EQ(flown.frame.tolerance_used, fresh.frame.tolerance_used);
        }
    }
}

TEST(FacadeMaps, ConvertedMapsAreInTheFormAskedForAndCounted) {
    const SyntheticCity& city = shared_city();
    for (const bool boxes : {false, true}) {
        StreamerOptions options;
        options.facade_form = codec::facade::FacadeForm::kRaw;
        options.facade_boxes = boxes;
        Flight flight(city, options);
        std::set<MapPiece> drawn;
        for (const TileDraw& draw : flight.update(camera_at(city, 8))) {
            for (const FacadeMapBinding& binding : draw.facade_maps) {
                const MapPiece piece = map_piece(binding.map, binding.level);
                const auto grid = codec::facade::decode_form(city.words_of_piece.at(piece));
                ASSERT_TRUE(grid);
                const auto expected = codec::facade::encode_raw_map(*grid, boxes);
                ASSERT_TRUE(expected);
                EXPECT_TRUE(std::ranges::equal(flight.store.words_of(binding.layer), *expected));
                drawn.insert(piece);
            }
        }
        EXPECT_FALSE(drawn.empty());
        EXPECT_EQ(flight.frame.map_conversions, drawn.size());
        EXPECT_EQ(flight.frame.map_conversions_refused, 0u);
        EXPECT_GT(flight.frame.map_conversion_ms, 0);
        flight.update(camera_at(city, 8));
        EXPECT_EQ(flight.frame.map_conversions, 0u);
    }
}

TEST(FacadeMaps, ConvertingHoldsBothBudgetsThoughSizesAreLearntLate) {
    const SyntheticCity& city = shared_city();
    for (const bool wait : {true, false}) {
        StreamerOptions options;
        options.wait_for_selection = wait;
        options.host_budget_bytes = 700u << 10;
        options.facade_form = codec::facade::FacadeForm::kRaw;
        Flight flight(city, options, 140 << 10, 1024);
        flight.fetcher.random_order = true;
        flight.fetcher.per_poll = 5;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 60);
        uint64_t conversions = 0, relief = 0;
        double coarsest = 0;
        for (int i = 0; i < 80; ++i) {
            const Camera camera = city.camera(place(random), place(random), height(random), turn(random), -10);
            for (int still = 0; still < (wait ? 1 : 4); ++still) {
                flight.update(camera);
                EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
                EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
                EXPECT_EQ(flight.store.refused_appends(), 0u) << "an append was not planned for";
                conversions += flight.frame.map_conversions;
                relief += flight.frame.relief_tiles;
                coarsest = std::max(coarsest, flight.frame.tolerance_used);
            }
        }
        EXPECT_GT(conversions, 20u);
        EXPECT_GT(relief, 20u);
        EXPECT_GT(coarsest, 1.0) << "the budget was never felt: the test is too easy";
    }
}

TEST(FacadeMaps, MapsThatNoBudgetHoldsOnceConvertedAreLeftFlatWithAWarning) {
    test::SyntheticOptions wide;
    wide.map_width = 4000;  // a few hundred bytes as shipped, hundreds of kilobytes raw
    const SyntheticCity city(wide);
    StreamerOptions little_host, little_gpu;
    little_host.facade_form = little_gpu.facade_form = codec::facade::FacadeForm::kRaw;
    little_host.host_budget_bytes = 1 << 20;
    const std::pair<StreamerOptions, uint64_t> budgets[] = {{little_host, 64u << 20}, {little_gpu, 256u << 10}};
    for (const auto& [options, gpu_bytes] : budgets) {
        Flight flight(city, options, gpu_bytes, 512);
        flight.update(camera_at(city, 8));
        EXPECT_FALSE(flight.frame.warnings.empty());
        for (const std::string& warning : flight.frame.warnings) {
            EXPECT_NE(warning.find("too large"), std::string::npos) << warning;
        }
        EXPECT_EQ(flight.frame.relief_tiles, 0u);
        EXPECT_GT(flight.frame.flat_tiles, 0u);
        EXPECT_GT(flight.frame.tiles_drawn, 0u);
        EXPECT_EQ(flight.frame.tiles_missing, 0u);
        EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
        EXPECT_EQ(flight.store.refused_appends(), 0u);
        flight.update(camera_at(city, 8));
        EXPECT_EQ(flight.frame.requests, 0u);
        EXPECT_EQ(flight.frame.map_conversions, 0u) << "given up for good";
        Flight as_shipped(city, {}, 64u << 20, 512);
        as_shipped.update(camera_at(city, 8));
        EXPECT_GT(as_shipped.frame.relief_tiles, 0u);
    }
}

TEST(FacadeMaps, ACityWithoutReliefNeverAsksForTheDictionary) {
    test::SyntheticOptions plain;
    plain.facades = false;
    const SyntheticCity without(plain);
    const SyntheticCity& with = shared_city();
    for (const SyntheticCity* city : {&without, &with}) {
        Flight flight(*city);
        uint64_t drawn = 0;
        for (int i = 0; i < 10; ++i) {
            // Near the ground of the city that has no facades; high above the one that has some.
            const double height = city == &without ? 15 : 150;
            drawn += flight.update(city->camera(100 * i, 50 * i, height, 20 * i, -30)).size();
            EXPECT_EQ(flight.frame.facade_index_bytes + flight.frame.facade_map_bytes, 0u);
            EXPECT_EQ(flight.frame.relief_tiles, 0u);
            EXPECT_EQ(flight.frame.facade_maps, (std::array<uint64_t, codec::facade::kMostFacadeLevels>{}));
        }
        EXPECT_GT(drawn, 10u);
        for (const FetchRequest& request : flight.fetcher.log) {
            EXPECT_FALSE(request.path.starts_with("facades/")) << request.path;
            EXPECT_FALSE(request.path.ends_with(".facade")) << request.path;
        }
    }
}

TEST(FacadeMaps, FramesCountTheDictionaryByIndexAndMapsAndWhatIsInTheStoreByLevel) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    const auto& draws = flight.update(camera_at(city, 8));
    EXPECT_EQ(flight.frame.facade_index_bytes, city.entries.at(kFacadeIndexPath).size());
    uint64_t map_bytes = 0;
    for (const FetchRequest& request : map_requests(flight)) map_bytes += request.length;
    EXPECT_EQ(flight.frame.facade_map_bytes, map_bytes);
    std::array<std::set<uint32_t>, codec::facade::kMostFacadeLevels> bound;
    uint64_t relief = 0;
    for (const TileDraw& draw : draws) {
        relief += draw.facade != kNoLayer ? 1 : 0;
        for (const FacadeMapBinding& binding : draw.facade_maps) bound[binding.level].insert(binding.map);
    }
    EXPECT_EQ(flight.frame.relief_tiles, relief);
    for (size_t level = 0; level < bound.size(); ++level) {
        EXPECT_EQ(flight.frame.facade_maps[level], bound[level].size());
    }
}

TEST(FacadeMaps, LoadClientsAskForTheSameLevels) {
    const SyntheticCity& city = shared_city();
    StreamerOptions counting;
    counting.decode = false;
    Flight drawing(city), loading(city, counting);
    uint64_t map_bytes = 0;
    for (const double metres : {55.0, 30.0, 10.0, 30.0, 55.0}) {
        const auto picture = picture_of(drawing.update(camera_at(city, metres)));
        EXPECT_EQ(picture, picture_of(loading.update(camera_at(city, metres))));
        EXPECT_EQ(drawing.frame.facade_map_bytes, loading.frame.facade_map_bytes);
        EXPECT_EQ(drawing.frame.gpu_bytes_used, loading.frame.gpu_bytes_used);
        map_bytes += loading.frame.facade_map_bytes;
    }
    EXPECT_GT(map_bytes, 0u);
}

}  // namespace
}  // namespace citystream::client
