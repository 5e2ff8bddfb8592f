#include "client/stream/light_residency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "client/stream/request_plan.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using codec::radiance::MatrixForm;
using test::Flight;
using test::Layer;
using test::realtime;
using test::SyntheticCity;
using test::TileAddress;

constexpr double kFinest = 0;

test::SyntheticOptions with_light() {
    test::SyntheticOptions options;
    options.light = 5;
    return options;
}

/// Quick to make.
test::SyntheticOptions small_with_light() {
    test::SyntheticOptions options = with_light();
    options.levels = 3;
    options.chart_size = 8;
    options.facades = false;
    return options;
}

const SyntheticCity& lit_city() {
    static const SyntheticCity city(with_light());
    return city;
}

StreamerOptions lit(double tolerance = kFinest, StreamerOptions options = {}) {
    options.light_tolerance = tolerance;
    return options;
}

bool is_of_light(const FetchRequest& request) {
    return request.path.ends_with(".radiance");
}

Camera street(const SyntheticCity& city) {
    return city.camera(70, 20, 15, 20, -15);
}

/// The codec's words of a tile's first steps; none where it refuses them.
std::vector<uint32_t> light_words(const SyntheticCity& city, TileAddress address, size_t steps, MatrixForm form) {
    const auto& entry = city.entries.at(layer_path(Layer::kRadiance, address));
    const auto& records = city.tile(address).steps(Layer::kRadiance);
    std::vector<std::span<const std::byte>> wire;
    uint64_t decoded = 0;
    for (size_t i = 0; i < std::min(steps, records.size()); ++i) {
        const uint64_t begin = i > 0 ? records[i - 1].end : 0;
        wire.push_back(std::span(entry).subspan(begin, records[i].end - begin));
        decoded += records[i].decoded_bytes;
    }
    auto words = codec::radiance::decode_radiance_layer(wire, decoded, form);
    return words ? std::move(*words) : std::vector<uint32_t>();
}

/// How many steps of its light a draw shows; the words are the codec's. 0: none.
size_t steps_shown(const Flight& flight, const TileDraw& draw, MatrixForm form = MatrixForm::kBiclusters) {
    if (draw.radiance == kNoLayer) return 0;
    const auto words = flight.store.words_of(draw.radiance);
    for (size_t steps = flight.city.tile(draw.address).steps(Layer::kRadiance).size(); steps > 0; --steps) {
        if (std::ranges::equal(words, light_words(flight.city, draw.address, steps, form))) return steps;
    }
    ADD_FAILURE() << "words that are no prefix of the tile's light";
    return 0;
}

std::map<TileAddress, size_t> all_steps_shown(const Flight& flight, const std::vector<TileDraw>& draws) {
    std::map<TileAddress, size_t> steps;
    for (const TileDraw& draw : draws) steps[draw.address] = steps_shown(flight, draw);
    return steps;
}

/// All of a draw but its light, as far as it does not depend on the order in which layers came.
auto surface_of(const TileDraw& draw) {
    return std::tuple(draw.address, draw.mesh_steps, draw.atlas_finest_mip, draw.facade != kNoLayer,
                      draw.facade_maps.size());
}

void expect_same_surfaces(const std::vector<TileDraw>& a, const std::vector<TileDraw>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(surface_of(a[i]), surface_of(b[i]));
}

TEST(LightResidency, WithoutAToleranceNothingOfItIsAskedForOrDrawn) {
    Flight flight(lit_city());
    for (int i = 0; i < 5; ++i) {
        for (const TileDraw& draw : flight.update(lit_city().camera(100 + 50 * i, 60, 20, 30 * i, -20)))
            EXPECT_EQ(draw.radiance, kNoLayer);
        EXPECT_EQ(flight.frame.layer_bytes[static_cast<size_t>(Layer::kRadiance)], 0U);
        EXPECT_EQ(flight.frame.light_tiles + flight.frame.light_layers + flight.frame.light_decodes, 0U);
        EXPECT_EQ(flight.frame.light_tolerance_used, 0);
    }
    EXPECT_TRUE(std::ranges::none_of(flight.fetcher.log, is_of_light));
}

TEST(LightResidency, ACityWithoutLightIsFlownAsWithoutATolerance) {
    const SyntheticCity city;
    Flight plain(city), asking(city, lit());
    expect_same_surfaces(plain.update(street(city)), asking.update(street(city)));
    EXPECT_EQ(asking.frame.light_tiles, 0U);
    EXPECT_EQ(plain.frame.wire_bytes, asking.frame.wire_bytes);
    EXPECT_EQ(plain.frame.gpu_bytes_used, asking.frame.gpu_bytes_used);
    EXPECT_TRUE(asking.frame.warnings.empty());
}

TEST(LightResidency, EveryTileIsDrawnWithThePrefixThatItsToleranceWants) {
    std::set<size_t> seen;
    for (const double tolerance : {0.0, 0.1, 0.2, 1.0}) {
        Flight flight(lit_city(), lit(tolerance));
        const auto& draws = flight.update(street(lit_city()));
        ASSERT_GT(draws.size(), 4U);
        for (const TileDraw& draw : draws) {
            const auto& steps = lit_city().tile(draw.address).steps(Layer::kRadiance);
            const size_t shown = steps_shown(flight, draw);
            seen.insert(shown);
            EXPECT_TRUE(shown == steps.size() || steps[shown - 1].error <= tolerance);
            EXPECT_TRUE(shown == 1 || steps[shown - 2].error > tolerance);
        }
        EXPECT_EQ(flight.frame.light_tiles, draws.size());
        EXPECT_EQ(flight.frame.light_layers, draws.size());
        EXPECT_EQ(flight.frame.light_decodes, draws.size());
        EXPECT_EQ(flight.frame.light_tolerance_used, tolerance);
        flight.update(street(lit_city()));
        EXPECT_EQ(flight.frame.requests + flight.frame.light_decodes, 0U);
    }
    EXPECT_GE(seen.size(), 2U) << "all tolerances wanted the same: the test is too easy";
}

TEST(LightResidency, TheMatrixHasTheFormAskedFor) {
    StreamerOptions options = lit();
    options.matrix_form = MatrixForm::kRows;
    Flight flight(lit_city(), options);
    for (const TileDraw& draw : flight.update(street(lit_city())))
        EXPECT_GT(steps_shown(flight, draw, MatrixForm::kRows), 0U);
}

TEST(LightResidency, ItIsAskedForWhenAllElseIsHere) {
    Flight flight(lit_city(), lit());
    flight.update(street(lit_city()));
    const auto first = std::ranges::find_if(flight.fetcher.log, is_of_light);
    ASSERT_NE(first, flight.fetcher.log.end());
    EXPECT_TRUE(std::all_of(first, flight.fetcher.log.end(), is_of_light));
    for (auto at = first; at != flight.fetcher.log.end(); ++at) {
        EXPECT_TRUE(std::all_of(flight.fetcher.log.begin(), first,
                                [&](const FetchRequest& request) { return request.priority > at->priority; }));
    }
}

TEST(LightResidency, NoneOfItComesForHiddenTiles) {
    uint64_t hidden = 0;
    for (int i = 0; i < 12; ++i) {
        Flight flight(lit_city(), lit());
        std::set<std::string> drawn;
        for (const TileDraw& draw : flight.update(lit_city().camera(80 * i, 500, 2, 30 * i, 0)))
            drawn.insert(layer_path(Layer::kRadiance, draw.address));
        for (const FetchRequest& request : flight.fetcher.log) {
            if (!is_of_light(request)) continue;
            EXPECT_TRUE(drawn.contains(request.path)) << request.path;
        }
        hidden += flight.frame.tiles_hidden;
    }
    EXPECT_GT(hidden, 0U) << "nothing was hidden: the test is too easy";
}

TEST(LightResidency, WhatIsShownDoesNotDependOnThreadsOrTheOrderOfArrival) {
    StreamerOptions one = lit(), many = lit();
    one.light_threads = 1;
    many.light_threads = 7;
    Flight orderly(lit_city(), one), shuffled(lit_city(), many);
    shuffled.fetcher.random_order = true;
    for (int i = 0; i < 4; ++i) {
        const Camera camera = lit_city().camera(80 * i, 500, 25, 30 * i, -15);
        const auto& a = orderly.update(camera);
        const auto& b = shuffled.update(camera);
        expect_same_surfaces(a, b);
        EXPECT_EQ(all_steps_shown(orderly, a), all_steps_shown(shuffled, b));
        EXPECT_EQ(orderly.frame.wire_bytes, shuffled.frame.wire_bytes);
        EXPECT_EQ(orderly.frame.decoded_bytes, shuffled.frame.decoded_bytes);
    }
}

TEST(LightResidency, ItNeverCostsGeometryWhateverTheBudgets) {
    uint64_t lit_tiles = 0, unlit_tiles = 0;
    for (const uint64_t gpu : {uint64_t{60} << 10, uint64_t{120} << 10, uint64_t{400} << 10, uint64_t{4} << 20}) {
        StreamerOptions options;
        options.host_budget_bytes = 15 << 20;
        Flight plain(lit_city(), options, gpu, 1024), flight(lit_city(), lit(kFinest, options), gpu, 1024);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 300);
        for (int i = 0; i < 12; ++i) {
            const Camera camera = lit_city().camera(place(random), place(random), height(random), turn(random), -20);
            const auto& draws = flight.update(camera);
            expect_same_surfaces(plain.update(camera), draws);
            EXPECT_EQ(plain.frame.tolerance_used, flight.frame.tolerance_used);
            EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
            EXPECT_EQ(flight.store.refused_appends(), 0U);
            lit_tiles += flight.frame.light_tiles;
            unlit_tiles += draws.size() - flight.frame.light_tiles;
        }
    }
    EXPECT_GT(lit_tiles, 0U);
    EXPECT_GT(unlit_tiles, 0U) << "the budget was never felt: the test is too easy";
}

TEST(LightResidency, BothBudgetsHoldInEveryFrame) {
    for (const bool wait : {true, false}) {
        StreamerOptions options = lit();
        options.wait_for_selection = wait;
        options.host_budget_bytes = 20U << 20;  // a tile is decoded at a time
        Flight flight(lit_city(), options, 150 << 10, 1024);
        flight.fetcher.random_order = true;
        flight.fetcher.per_poll = 5;
        std::mt19937 random(11);
        std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 300);
        uint64_t lit_tiles = 0;
        for (int i = 0; i < 30; ++i) {
            const Camera camera = lit_city().camera(place(random), place(random), height(random), turn(random), -20);
            for (int still = 0; still < (wait ? 1 : 8); ++still) {
                flight.update(camera);
                if (!wait) std::this_thread::sleep_for(std::chrono::milliseconds(1));
                EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
                EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
                EXPECT_EQ(flight.store.refused_appends(), 0U);
                lit_tiles += flight.frame.light_tiles;
            }
        }
        EXPECT_GT(lit_tiles, 0U);
    }
}

TEST(LightResidency, ALongerPrefixTakesThePlaceOfAShorterOne) {
    size_t grown = 0;
    for (const uint64_t gpu : {uint64_t{110} << 10, uint64_t{130} << 10, uint64_t{150} << 10}) {
        Flight flight(lit_city(), lit(kFinest, test::whole_view()), gpu, 1024);
        // Room for little light of many tiles, then for all light of the nearest.
        const auto before = all_steps_shown(flight, flight.update(lit_city().camera(512, 0, 60, 0, -20)));
        const bool less = std::ranges::any_of(before, [](const auto& tile) { return tile.second < 3; });
        const bool said = std::ranges::any_of(flight.frame.warnings, [](const std::string& text) {
            return text.find("do not hold all light") != std::string::npos;
        });
        EXPECT_EQ(less, said);
        const auto after = all_steps_shown(flight, flight.update(lit_city().camera(512, 0, 60, 0, -75)));
        for (const auto& [address, steps] : after) {
            const auto was = before.find(address);
            if (was != before.end() && was->second > 0 && was->second < steps) ++grown;
        }
    }
    EXPECT_GT(grown, 0U) << "no tile's light grew: the test is too easy";
}

TEST(LightResidency, ALossyMatrixTakesLessAndSaysWhatItLeftOut) {
    Flight exact(lit_city(), lit());
    exact.update(street(lit_city()));
    EXPECT_EQ(exact.frame.light_row_error, 0);
    EXPECT_EQ(exact.frame.light_quarters_dropped, 0U);
    StreamerOptions options = lit();
    options.matrix_error = 0.2;
    Flight lossy(lit_city(), options);
    const auto& draws = lossy.update(street(lit_city()));
    EXPECT_GT(lossy.frame.light_row_error, 0);
    EXPECT_LE(lossy.frame.light_row_error, options.matrix_error);
    EXPECT_GT(lossy.frame.light_quarters_dropped, 0U);
    EXPECT_LT(lossy.frame.light_bytes, exact.frame.light_bytes);
    EXPECT_EQ(lossy.frame.light_tiles, draws.size());
    EXPECT_EQ(lossy.frame.layer_bytes, exact.frame.layer_bytes);
}

TEST(LightResidency, WhatTheDirectoryAllowedForBeyondWhatIsTakenGoesToOtherTiles) {
    size_t gained = 0;
    for (const uint64_t gpu : {uint64_t{100} << 10, uint64_t{120} << 10, uint64_t{140} << 10, uint64_t{160} << 10}) {
        Flight flight(lit_city(), lit(kFinest, test::whole_view()), gpu, 1024);
        const auto& draws = flight.update(lit_city().camera(512, 0, 60, 0, -20));
        uint64_t allowed = 0, taken = 0;
        for (const TileDraw& draw : draws) {
            const auto& steps = lit_city().tile(draw.address).steps(Layer::kRadiance);
            const size_t shown = steps_shown(flight, draw);
            for (size_t i = 0; i < shown; ++i) allowed += steps[i].decoded_bytes;
            if (shown > 0) taken += 4 * flight.store.words_of(draw.radiance).size();
        }
        EXPECT_EQ(taken, flight.frame.light_bytes);
        EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
        EXPECT_EQ(flight.store.refused_appends(), 0U);
        const uint64_t others = flight.store.slots_used() * flight.store.slot_bytes() - taken;
        gained += others + allowed > gpu ? 1 : 0;
    }
    EXPECT_GT(gained, 0U) << "no view has more light than the directory's sizes have room for";
}

TEST(LightResidency, ADamagedStepIsTriedOnceMore) {
    Flight flight(lit_city(), lit());
    flight.fetcher.damage_times["tiles/3/0/0.radiance"] = 1;
    flight.update(street(lit_city()));
    EXPECT_EQ(std::ranges::count_if(flight.fetcher.log,
                                    [](const FetchRequest& r) { return r.path == "tiles/3/0/0.radiance"; }),
              2);
    EXPECT_TRUE(flight.frame.warnings.empty());
    EXPECT_EQ(flight.frame.light_tiles, flight.frame.tiles_drawn);
}

TEST(LightResidency, ATileWhoseLightIsDamagedOrMissingIsDrawnWithoutIt) {
    for (const bool missing : {false, true}) {
        Flight flight(lit_city(), lit());
        (missing ? flight.fetcher.missing_times : flight.fetcher.damage_times)["tiles/3/0/0.radiance"] = 1000;
        const auto& draws = flight.update(street(lit_city()));
        const TileDraw* draw = test::draw_of(lit_city(), draws, {3, 0, 0});
        ASSERT_NE(draw, nullptr);
        EXPECT_EQ(draw->radiance, kNoLayer);
        EXPECT_EQ(flight.frame.light_tiles + 1, flight.frame.tiles_drawn);
        EXPECT_EQ(flight.frame.tiles_missing, 0U);
        ASSERT_EQ(flight.frame.warnings.size(), 1U);
        EXPECT_NE(flight.frame.warnings[0].find("tiles/3/0/0.radiance"), std::string::npos);
        EXPECT_NE(flight.frame.warnings[0].find("the sky's"), std::string::npos) << flight.frame.warnings[0];
        flight.update(street(lit_city()));
        EXPECT_EQ(flight.frame.requests, 0U);
    }
}

/// Bytes with the right checksum that the codec refuses.
TEST(LightResidency, HostileStepsLeaveThePrefixBeforeThem) {
    for (const size_t bad : {size_t{0}, size_t{1}, size_t{2}}) {
        test::SyntheticOptions options = small_with_light();
        options.change_light = {TileAddress{2, 0, 0}, [bad](auto& steps) {
                                    ASSERT_EQ(steps.size(), 3U);
                                    steps[bad].wire.assign(steps[bad].wire.size(), std::byte{0xff});
                                    if (bad > 0) steps[bad].wire.resize(1);
                                }};
        const SyntheticCity city(options);
        Flight flight(city, lit());
        const auto& draws = flight.update(street(city));
        const TileDraw* draw = test::draw_of(city, draws, {2, 0, 0});
        ASSERT_NE(draw, nullptr);
        EXPECT_EQ(steps_shown(flight, *draw), bad);
        ASSERT_EQ(flight.frame.warnings.size(), 1U);
        EXPECT_NE(flight.frame.warnings[0].find("step " + std::to_string(bad)), std::string::npos)
            << flight.frame.warnings[0];
        flight.update(street(city));
        EXPECT_EQ(flight.frame.requests + flight.frame.light_decodes, 0U);
    }
}

TEST(LightResidency, TheDirectoryCannotPromiseLessThanTheWordsTake) {
    test::SyntheticOptions options = small_with_light();
    options.change_light = {TileAddress{2, 0, 0}, [](auto& steps) {
                                for (auto& step : steps) step.decoded_bytes = 64;
                            }};
    const SyntheticCity city(options);
    Flight flight(city, lit());
    const TileDraw* draw = test::draw_of(city, flight.update(street(city)), {2, 0, 0});
    ASSERT_NE(draw, nullptr);
    EXPECT_EQ(draw->radiance, kNoLayer);
    EXPECT_EQ(flight.frame.warnings.size(), 1U);
}

/// light_words of the lit city, each made once.
const std::vector<uint32_t>& lit_words(TileAddress address, size_t steps, MatrixForm form) {
    static std::map<std::tuple<TileAddress, size_t, MatrixForm>, std::vector<uint32_t>> made;
    const auto [at, is_new] = made.try_emplace({address, steps, form});
    if (is_new) at->second = light_words(lit_city(), address, steps, form);
    return at->second;
}

/// Updates a realtime flight until `done` says so of its draws; false: it never did.
template <typename Done>
bool update_until(Flight& flight, const Camera& camera, const Done& done) {
    for (int i = 0; i < 3000; ++i) {
        if (done(flight.update(camera))) return true;
        EXPECT_EQ(flight.store.refused_appends(), 0U);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

bool has_all_own_light(const Flight& flight, const std::vector<TileDraw>& draws) {
    return !draws.empty() && flight.frame.light_tiles == draws.size() && flight.frame.tiles_missing == 0;
}

/// All of a tile's light in the form asked for.
bool shows_all(const Flight& flight, const TileDraw& draw) {
    return draw.radiance != kNoLayer && std::ranges::equal(flight.store.words_of(draw.radiance),
                                                           lit_words(draw.address, 3, MatrixForm::kBiclusters));
}

TEST(LightResidency, RealtimeFramesDoNotWaitForItAndShowItWhenItIsThere) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    uint64_t frames_without = 0;
    EXPECT_TRUE(update_until(flight, street(lit_city()), [&](const std::vector<TileDraw>& draws) {
        if (!draws.empty() && flight.frame.light_tiles < draws.size()) ++frames_without;
        return has_all_own_light(flight, draws) &&
               std::ranges::all_of(draws, [&](const TileDraw& draw) { return shows_all(flight, draw); });
    }));
    EXPECT_GT(frames_without, 0U);
    for (int i = 0; i < 5; ++i) {
        flight.update(street(lit_city()));
        EXPECT_EQ(flight.frame.requests + flight.frame.light_decodes, 0U);
    }
}

TEST(LightResidency, InRealtimeItWaitsUntilTheViewHasAPicture) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    flight.fetcher.per_poll = 1;
    size_t gaps = 0;
    const auto all = [&](const std::vector<TileDraw>& draws) { return has_all_own_light(flight, draws); };
    EXPECT_TRUE(update_until(flight, street(lit_city()), [&](const std::vector<TileDraw>& draws) {
        const auto asked = std::ranges::count_if(flight.fetcher.log, is_of_light);
        if (flight.frame.tiles_missing > 0) {
            EXPECT_EQ(asked, 0);
            ++gaps;
        }
        return all(draws);
    }));
    EXPECT_GT(gaps, 5U) << "all came at once: the test is too easy";
}

TEST(LightResidency, InRealtimeATilesFirstStepComesAloneAndTheRestWhenThatIsInTheStore) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    std::map<std::string, std::vector<FetchRequest>> asked;
    std::set<std::string> opened;  // drawn with light of their own
    size_t seen = 0;
    EXPECT_TRUE(update_until(flight, street(lit_city()), [&](const std::vector<TileDraw>& draws) {
        for (const TileDraw& draw : draws) {
            if (draw.radiance == kNoLayer) continue;
            const auto& opening = lit_words(draw.address, 1, MatrixForm::kRows);
            if (std::ranges::equal(flight.store.words_of(draw.radiance), opening))
                opened.insert(layer_path(Layer::kRadiance, draw.address));
        }
        for (; seen < flight.fetcher.log.size(); ++seen) {
            const FetchRequest& request = flight.fetcher.log[seen];
            if (!is_of_light(request)) continue;
            asked[request.path].push_back(request);
            EXPECT_EQ(asked[request.path].size() == 1, !opened.contains(request.path)) << request.path;
        }
        return has_all_own_light(flight, draws) &&
               std::ranges::all_of(draws, [&](const TileDraw& draw) { return shows_all(flight, draw); });
    }));
    for (const TileDraw& draw : flight.update(street(lit_city()))) {
        const auto& steps = lit_city().tile(draw.address).steps(Layer::kRadiance);
        const auto& requests = asked.at(layer_path(Layer::kRadiance, draw.address));
        ASSERT_EQ(requests.size(), 2U);
        EXPECT_EQ(requests[0].offset, 0U);
        EXPECT_EQ(requests[0].length, steps[0].end);
        EXPECT_EQ(requests[1].offset, steps[0].end);
        EXPECT_EQ(requests[1].length, steps[2].end - steps[0].end);
    }
}

/// Few requests under way leave connections idle for the next view's tiles.
TEST(LightResidency, InRealtimeFewRequestsForItAreUnderWayAtATime) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    const auto lights = [&] { return std::ranges::count_if(flight.fetcher.log, is_of_light); };
    ASSERT_TRUE(update_until(flight, street(lit_city()), [&](const auto&) { return lights() > 0; }));
    flight.fetcher.per_poll = 0;
    for (int i = 0; i < 20; ++i) flight.update(street(lit_city()));
    EXPECT_GE(flight.frame.tiles_drawn, 6U);
    EXPECT_LE(lights(), 3);
}

TEST(LightResidency, InRealtimeTheRootsFirstStepIsAskedForBeforeAllOtherLight) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    flight.fetcher.per_poll = 1;
    ASSERT_TRUE(update_until(flight, street(lit_city()),
                             [&](const std::vector<TileDraw>& draws) { return has_all_own_light(flight, draws); }));
    const auto first = std::ranges::find_if(flight.fetcher.log, is_of_light);
    EXPECT_EQ(first->path, "tiles/0/0/0.radiance");
    EXPECT_EQ(first->length, lit_city().tile({0, 0, 0}).steps(Layer::kRadiance)[0].end);
    for (const FetchRequest& request : flight.fetcher.log)
        EXPECT_TRUE(request.path != first->path || request.offset == 0) << "more of the root's light than one step";
}

TEST(LightResidency, InRealtimeATileWithoutItsOwnIsDrawnWithTheRoots) {
    Flight flight(lit_city(), lit(kFinest, realtime()));
    const TileAddress address = {3, 0, 0};
    flight.fetcher.missing_times[layer_path(Layer::kRadiance, address)] = 1000;
    ASSERT_TRUE(update_until(flight, street(lit_city()), [&](const std::vector<TileDraw>& draws) {
        const TileDraw* draw = test::draw_of(lit_city(), draws, address);
        return draw != nullptr && draw->radiance != kNoLayer && flight.frame.light_tiles + 1 == draws.size();
    }));
    EXPECT_EQ(flight.frame.light_inherited_tiles, 1U);
    const TileDraw* draw = test::draw_of(lit_city(), flight.update(street(lit_city())), address);
    ASSERT_NE(draw, nullptr);
    const auto& manifest = lit_city().manifest;
    const GridPoint own = manifest.tile_origin(lit_city().tile(address));
    const GridPoint origin = manifest.tile_origin(lit_city().tile({0, 0, 0}));
    EXPECT_EQ(int64_t{draw->radiance_offset[0]}, own.x - origin.x);
    EXPECT_EQ(int64_t{draw->radiance_offset[1]}, own.y - origin.y);
    EXPECT_EQ(int64_t{draw->radiance_offset[2]}, own.z - origin.z);
    const auto words = flight.store.words_of(draw->radiance);
    EXPECT_TRUE(std::ranges::equal(words, lit_words({0, 0, 0}, 1, MatrixForm::kBiclusters)) ||
                std::ranges::equal(words, lit_words({0, 0, 0}, 1, MatrixForm::kRows)));
}

TEST(LightResidency, ARealtimeStreamerThatGoesAwayWaitsForItsThreads) {
    for (int updates = 2; updates < 12; ++updates) {
        Flight flight(lit_city(), lit(kFinest, realtime()));
        flight.fetcher.per_poll = 1000;
        for (int i = 0; i < updates; ++i) flight.update(street(lit_city()));
        flight.streamer.reset();
        EXPECT_EQ(flight.store.slots_used(), 0U);
    }
}

// It is what a streamer that goes away tells its threads.
TEST(LightResidency, DecodingThatIsStoppedHasNoWordsAndBlamesNoStep) {
    const TileAddress address = {3, 0, 0};
    const auto& entry = lit_city().entries.at(layer_path(Layer::kRadiance, address));
    const auto& records = lit_city().tile(address).steps(Layer::kRadiance);
    std::vector<std::vector<std::byte>> wire;
    uint64_t begin = 0;
    for (const auto& record : records) {
        wire.emplace_back(entry.begin() + static_cast<std::ptrdiff_t>(begin),
                          entry.begin() + static_cast<std::ptrdiff_t>(record.end));
        begin = record.end;
    }
    for (const bool stops : {false, true}) {
        const std::atomic<bool> stop = stops;
        DecodedLight light;
        DecodeFailure failure;
        EXPECT_EQ(decode_light(wire, records, {MatrixForm::kBiclusters, 0, &stop}, light, failure), !stops);
        EXPECT_EQ(light.words.empty(), stops);
        EXPECT_TRUE(failure.message.empty()) << failure.message;
    }
}

TEST(LightResidency, AClientThatDoesNotDecodeAsksForTheSameBytes) {
    StreamerOptions counting = lit();
    counting.decode = false;
    Flight drawing(lit_city(), lit(kFinest, test::whole_view())), loading(lit_city(), counting);
    for (int i = 0; i < 5; ++i) {
        const Camera camera = lit_city().camera(100 + 40 * i, 100, 30, 10 * i, -15);
        drawing.update(camera);
        loading.update(camera);
        EXPECT_EQ(drawing.frame.wire_bytes, loading.frame.wire_bytes);
        EXPECT_EQ(drawing.frame.layer_bytes, loading.frame.layer_bytes);
        EXPECT_EQ(drawing.frame.light_tiles, loading.frame.light_tiles);
        EXPECT_EQ(loading.frame.light_decodes, 0U);
    }
}

}  // namespace
}  // namespace citystream::client
