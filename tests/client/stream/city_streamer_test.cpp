#include "client/stream/city_streamer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "client/cache/directory_pool.h"
#include "client/cache/host_layer_store.h"
#include "client/select/selection.h"
#include "tests/client/stream/fake_fetcher.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::FakeFetcher;
using test::Flight;
using test::realtime;
using test::SyntheticCity;

const SyntheticCity& shared_city() {
    static const SyntheticCity city;
    return city;
}

/// Words of the first steps of a tile's mesh, by the codec.
std::vector<uint32_t> mesh_words(const SyntheticCity& city, test::TileAddress address, size_t steps) {
    const auto& entry = city.entries.at(layer_path(test::Layer::kMesh, address));
    const auto& records = city.tiles.at(address).steps(test::Layer::kMesh);
    std::vector<std::span<const std::byte>> wire;
    std::vector<uint32_t> decoded_bytes;
    for (size_t i = 0; i < std::min(steps, records.size()); ++i) {
        const uint64_t begin = i > 0 ? records[i - 1].end : 0;
        wire.push_back(std::span(entry).subspan(begin, records[i].end - begin));
        decoded_bytes.push_back(records[i].decoded_bytes);
    }
    const auto mesh = codec::mesh::decode_mesh_layer(wire, decoded_bytes, codec::mesh::kAnyMeshChart);
    return mesh ? mesh->words() : std::vector<uint32_t>();
}

/// The tiles that are drawn. What the store has of each are the codec's words of a prefix that is no shorter than what
/// is on show.
std::set<test::TileAddress> addresses_of(const Flight& flight, const std::vector<TileDraw>& draws) {
    std::set<test::TileAddress> out;
    for (const TileDraw& draw : draws) {
        const std::span<const uint32_t> words = flight.store.words_of(draw.mesh);
        bool found = false;
        for (uint32_t steps = draw.mesh_steps; steps <= codec::mesh::kMostMeshSteps && !found; ++steps)
            found = std::ranges::equal(words, mesh_words(flight.city, draw.address, steps));
        EXPECT_TRUE(found) << "a drawn mesh that is not its tile's";
        out.insert(draw.address);
    }
    return out;
}

/// How many drawn tiles cover the middle of a finest cell.
int times_covered(const std::set<test::TileAddress>& drawn, test::TileAddress leaf) {
    int count = 0;
    for (test::TileAddress at = leaf;; at = at.parent()) {
        if (drawn.contains(at)) ++count;
        if (at.level == 0) return count;
    }
}

/// Every leaf in view covered exactly once.
void expect_exact_cover(const Flight& flight, const Camera& camera, const std::set<test::TileAddress>& drawn) {
    for (const auto& [address, record] : flight.city.tiles) {
        if (address.level + 1 != flight.city.manifest.levels || !camera.sees(record.bounds, flight.city.origin()))
            continue;
        EXPECT_EQ(times_covered(drawn, address), 1) << "leaf " << address.level << "/" << address.x << "/" << address.y;
    }
}

TEST(CityStreamer, DrawsWhatItChoseAndAStaticCameraAsksForNothingMore) {
    Flight flight(shared_city());
    const Camera camera = shared_city().camera(512, 200, 60, 20, -15);
    const auto& draws = flight.update(camera);
    EXPECT_GT(draws.size(), 4u);
    EXPECT_GT(flight.frame.requests, 0u);
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
    EXPECT_LE(flight.frame.achieved_error_pixels, 100);
    EXPECT_TRUE(flight.frame.warnings.empty());
    expect_exact_cover(flight, camera, addresses_of(flight, draws));
    for (int i = 0; i < 3; ++i) {
        flight.update(camera);
        EXPECT_EQ(flight.frame.requests, 0u);
        EXPECT_EQ(flight.frame.wire_bytes, 0u);
        EXPECT_EQ(flight.frame.cache_misses, 0u);
    }
}

TEST(CityStreamer, TurningRoundAndBackWithinTheBudgetAsksForNothing) {
    Flight flight(shared_city());
    const Camera there = shared_city().camera(512, 512, 30, 0, -10);
    const Camera back = shared_city().camera(512, 512, 30, 180, -10);
    flight.update(there);
    flight.update(back);
    flight.update(there);
    EXPECT_EQ(flight.frame.requests, 0u);
    flight.update(back);
    EXPECT_EQ(flight.frame.requests, 0u);
}

TEST(CityStreamer, RefiningMovesOnlyTheBytesBetweenPrefixes) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    // From high above straight down to one leaf: bytes received of every layer are exactly its wanted prefix, however
    // it came.
    for (double z = 3000; z > 25; z *= 0.7) flight.update(city.camera(70, 70, z, 0, -89.9, 30));
    std::map<std::string, uint64_t> received = flight.fetcher.take_bytes();
    std::map<std::string, std::set<uint64_t>> prefix_ends;
    uint32_t refined = 0;
    for (const auto& [address, record] : city.tiles) {
        for (size_t layer = 0; layer < tiles::tileset::kLayerCount; ++layer) {
            const auto found = received.find(layer_path(static_cast<test::Layer>(layer), address));
            if (found == received.end()) continue;
            bool is_prefix = false;
            for (const auto& step : record.layers[layer]) is_prefix = is_prefix || step.end == found->second;
            EXPECT_TRUE(is_prefix) << found->first << ": " << found->second << " bytes are no prefix of the directory";
        }
    }
    // Ranges of one entry join without overlap, and some entry came in several.
    std::map<std::string, uint64_t> end_of;
    for (const FetchRequest& request : flight.fetcher.log) {
        if (!request.path.starts_with("tiles/")) continue;
        EXPECT_EQ(request.offset, end_of[request.path]) << request.path;
        if (request.offset > 0) ++refined;
        end_of[request.path] = request.offset + request.length;
    }
    EXPECT_GT(refined, 3u);
}

TEST(CityStreamer, NoByteIsFetchedForAChoiceThatSubtreesChange) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    const Camera camera = city.camera(70, 70, 40, 45, -45);
    flight.update(camera);
    std::set<std::string> wanted_entries;
    DirectoryCache directory(city.manifest, nullptr);
    ASSERT_TRUE(directory.add_subtree(city.entries.at("subtrees/0/0/0.subtree"), {}));
    for (const auto& [address, record] : city.tiles) {
        if (address.level != city.manifest.subtree_levels) continue;
        ASSERT_TRUE(directory.add_subtree(city.entries.at(subtree_path(address)), address));
    }
    CityKnowledge knowledge;
    knowledge.tiles.resize(directory.nodes().size());
    Selector selector(directory, knowledge);
    for (const SelectedTile& tile : selector.select(camera, 1.0, 4096).tiles) {
        for (size_t layer = 0; layer < tiles::tileset::kLayerCount; ++layer) {
            if (tile.steps[layer] == 0) continue;
            wanted_entries.insert(
                layer_path(static_cast<test::Layer>(layer), directory.node(tile.node).record->address));
        }
    }
    for (const auto& [path, bytes] : flight.fetcher.take_bytes()) {
        if (path.starts_with("tiles/")) {
            EXPECT_TRUE(wanted_entries.contains(path)) << path;
        }
    }
}

TEST(CityStreamer, FacadesComeWithEveryMapOnceAndOnlyWhereTheirReliefShows) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    const auto& draws = flight.update(city.camera(70, 20, 15, 20, -15));
    uint32_t with_relief = 0, flat = 0;
    for (const TileDraw& draw : draws) {
        if (draw.facade == kNoLayer) {
            ++flat;
            continue;
        }
        ++with_relief;
        EXPECT_EQ(draw.map_of_placement.size(), 3u);
        EXPECT_FALSE(draw.facade_maps.empty());
        for (const FacadeMapBinding& binding : draw.facade_maps) EXPECT_TRUE(flight.store.has(binding.layer));
        for (const uint32_t map : draw.map_of_placement) EXPECT_LT(map, draw.facade_maps.size());
    }
    EXPECT_GT(with_relief, 0u);
    EXPECT_GT(flat, 0u);
    std::set<uint64_t> seen;
    for (const FetchRequest& request : flight.fetcher.log) {
        if (request.path != tiles::tileset::kFacadeMapsPath) continue;
        for (uint64_t byte = request.offset; byte < request.offset + request.length; ++byte) {
            EXPECT_TRUE(seen.insert(byte).second) << "a map was sent twice";
        }
    }
    EXPECT_FALSE(seen.empty());
}

TEST(CityStreamer, DecodedWordsAreTheCodecsWords) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    const auto& draws = flight.update(city.camera(70, 70, 40, 45, -45));
    EXPECT_EQ(addresses_of(flight, draws).size(), draws.size());
    for (const TileDraw& draw : draws) {
        uint32_t triangles = 0, dressed = 0;
        for (const auto& range : draw.mesh_ranges) (range.dressed ? dressed : triangles) += range.triangles;
        EXPECT_EQ(triangles, 124u);
        EXPECT_EQ(dressed, 4u);
        EXPECT_GT(draw.mesh_steps, 0u);
        EXPECT_NE(draw.atlas, kNoLayer);
    }
}

TEST(CityStreamer, HoldsBothBudgetsInEveryFrameOfARandomWalkAndSaysWhatItGaveUp) {
    test::SyntheticOptions older;
    older.subtree_bytes_known = false;
    const SyntheticCity older_city(older);
    struct Case {
        bool wait, known, occlusion;
    };
    for (const auto& [wait, known, occlusion] :
         {Case{true, true, false}, Case{false, true, false}, Case{true, false, false}, Case{false, false, false},
          Case{true, true, true}}) {
        const SyntheticCity& city = known ? shared_city() : older_city;
        StreamerOptions options;
        options.wait_for_selection = wait;
        options.host_budget_bytes = 600u << 10;
        options.occlusion = occlusion;
        Flight flight(city, options, 90 << 10, 1024);
        flight.fetcher.random_order = true;
        flight.fetcher.per_poll = 5;
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(0, 1024), turn(0, 360), height(5, 300);
        double coarsest = 0;
        uint64_t most_host = 0;
        for (int i = 0; i < 120; ++i) {
            const Camera camera = city.camera(place(random), place(random), height(random), turn(random), -20);
            for (int still = 0; still < (wait ? 1 : 3); ++still) {
                const auto& draws = flight.update(camera);
                EXPECT_LE(flight.frame.host_bytes_used, options.host_budget_bytes);
                EXPECT_LE(flight.store.slots_used(), flight.store.slot_count());
                EXPECT_EQ(flight.store.refused_appends(), 0u) << "an append was not planned for";
                coarsest = std::max(coarsest, flight.frame.tolerance_used);
                most_host = std::max(most_host, flight.frame.host_bytes_used);
                if (wait) {
                    EXPECT_EQ(flight.frame.tiles_missing, 0u);
                    if (!occlusion) expect_exact_cover(flight, camera, addresses_of(flight, draws));
                }
            }
        }
        if (occlusion) continue;  // leaves less for the budgets to hold
        EXPECT_GT(coarsest, 1.0) << "the GPU budget was never felt: the test is too easy";
        EXPECT_GT(most_host, options.host_budget_bytes * 3 / 4)
            << "the host budget was never felt: the test is too easy";
    }
}

TEST(CityStreamer, EvictedLayersComeBackFromHostMemoryWithoutARequest) {
    const SyntheticCity& city = shared_city();
    Flight flight(city, {}, 120 << 10, 1024);
    const Camera there = city.camera(512, 512, 20, 0, -20), back = city.camera(512, 512, 20, 180, -20);
    flight.update(there);
    const double tolerance = flight.frame.tolerance_used;
    flight.update(back);
    flight.update(there);
    EXPECT_EQ(flight.frame.tolerance_used, tolerance);
    EXPECT_EQ(flight.frame.requests, 0u);
    EXPECT_GT(flight.frame.decoded_bytes, 0u) << "nothing had been evicted: the test is too easy";
}

TEST(CityStreamer, ADamagedStepIsTriedOnceMore) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    flight.fetcher.damage_times["tiles/3/0/0.mesh"] = 1;
    flight.update(city.camera(70, 20, 15, 20, -15));
    const auto asked = std::count_if(flight.fetcher.log.begin(), flight.fetcher.log.end(),
                                     [](const FetchRequest& r) { return r.path == "tiles/3/0/0.mesh"; });
    EXPECT_EQ(asked, 2);
    EXPECT_TRUE(flight.frame.warnings.empty());
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
}

TEST(CityStreamer, ATileDamagedTwiceIsDrawnFromItsParentWithOneWarning) {
    const SyntheticCity& city = shared_city();
    for (const char* path : {"tiles/3/0/0.mesh", "tiles/3/0/0.atlas"}) {
        Flight flight(city);
        flight.fetcher.damage_times[path] = 1000;
        const Camera camera = city.camera(70, 20, 15, 20, -15);
        const auto drawn = addresses_of(flight, flight.update(camera));
        EXPECT_TRUE(drawn.contains({2, 0, 0}));
        EXPECT_FALSE(drawn.contains({3, 0, 0}));
        EXPECT_FALSE(drawn.contains({3, 1, 1})) << "a sibling is drawn together with the parent";
        expect_exact_cover(flight, camera, drawn);
        ASSERT_EQ(flight.frame.warnings.size(), 1u);
        EXPECT_NE(flight.frame.warnings[0].find(path), std::string::npos);
        flight.update(camera);
        EXPECT_TRUE(flight.frame.warnings.empty());
        EXPECT_EQ(flight.frame.requests, 0u);
    }
}

TEST(CityStreamer, AMissingTileIsDrawnFromItsParent) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    flight.fetcher.missing_times["tiles/3/0/0.mesh"] = 1000;
    const Camera camera = city.camera(70, 20, 15, 20, -15);
    const auto drawn = addresses_of(flight, flight.update(camera));
    EXPECT_TRUE(drawn.contains({2, 0, 0}));
    expect_exact_cover(flight, camera, drawn);
    EXPECT_EQ(flight.frame.warnings.size(), 1u);
}

TEST(CityStreamer, ADamagedSubtreeLeavesItsParentDrawn) {
    const SyntheticCity& city = shared_city();
    Flight flight(city);
    flight.fetcher.damage_times["subtrees/2/0/0.subtree"] = 1000;
    const Camera camera = city.camera(70, 20, 15, 20, -15);
    const auto drawn = addresses_of(flight, flight.update(camera));
    EXPECT_TRUE(drawn.contains({1, 0, 0}));
    expect_exact_cover(flight, camera, drawn);
    EXPECT_EQ(flight.frame.warnings.size(), 1u);
}

TEST(CityStreamer, ADamagedFacadeMapOrIndexLeavesFacadesFlat) {
    const SyntheticCity& city = shared_city();
    for (const char* path : {tiles::tileset::kFacadeMapsPath, tiles::tileset::kFacadeIndexPath}) {
        Flight flight(city);
        flight.fetcher.damage_times[path] = 1000;
        const auto& draws = flight.update(city.camera(10, 10, 15, 45, -15));
        EXPECT_GT(draws.size(), 0u);
        EXPECT_EQ(flight.frame.tiles_missing, 0u);
        EXPECT_EQ(flight.frame.warnings.size(), 1u) << path;
    }
}

TEST(CityStreamer, RequestsOfATileThatLeftTheViewAreCancelled) {
    const SyntheticCity& city = shared_city();
    Flight flight(city, realtime());
    flight.fetcher.per_poll = 1000;
    const Camera there = city.camera(512, 512, 20, 0, -10), back = city.camera(512, 512, 20, 180, -10);
    for (int i = 0; i < 6; ++i) flight.update(there);
    // The directory of another place arrives, and its tiles are asked for.
    for (int i = 0; i < 2; ++i) flight.update(city.camera(480, 300, 20, 0, -10));
    flight.fetcher.per_poll = 0;
    const size_t before = flight.fetcher.log.size();
    for (int i = 0; i < 2; ++i) flight.update(back);
    flight.fetcher.per_poll = 1000;
    for (int i = 0; i < 20; ++i) flight.update(back);
    EXPECT_GT(flight.fetcher.log.size(), before);
    EXPECT_GT(flight.fetcher.cancelled_ids.size(), 0u);
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
}

TEST(CityStreamer, RealtimeCoverHasNeitherHolesNorOverlapsWhateverTheOrderOfArrival) {
    const SyntheticCity& city = shared_city();
    for (const uint64_t gpu : {uint64_t{64} << 20, uint64_t{120} << 10}) {
        Flight flight(city, realtime(), gpu, 2048);
        flight.fetcher.random_order = true;
        flight.fetcher.per_poll = 1000;
        for (int i = 0; i < 2; ++i) flight.update(city.camera(512, 512, 900, 0, -89));  // the root is here
        flight.fetcher.per_poll = 2;
        std::mt19937 random(3);
        double x = 500, y = 500, z = 80, yaw = 0;
        uint64_t stood_in = 0;
        for (int i = 0; i < 250; ++i) {
            x = std::clamp(x + static_cast<double>(random() % 81) - 40, 0.0, 1024.0);
            y = std::clamp(y + static_cast<double>(random() % 81) - 40, 0.0, 1024.0);
            z = std::clamp(z * (0.8 + 0.0045 * static_cast<double>(random() % 100)), 8.0, 600.0);
            yaw += static_cast<double>(random() % 61) - 30;
            const Camera camera = city.camera(x, y, z, yaw, -25);
            expect_exact_cover(flight, camera, addresses_of(flight, flight.update(camera)));
            stood_in += flight.frame.tiles_missing;
            ASSERT_EQ(flight.store.refused_appends(), 0u);
        }
        EXPECT_GT(stood_in, 0u) << "all came at once: the test is too easy";
    }
}

TEST(CityStreamer, MoreUrgentLayersAreAskedForFirst) {
    const SyntheticCity& city = shared_city();
    Flight flight(city, realtime());
    flight.fetcher.per_poll = 1000;
    const Camera camera = city.camera(512, 10, 20, 0, -10);
    size_t seen = 2, kinds_of_updates = 0;  // the manifest and the root subtree
    for (int i = 0; i < 4; ++i) {
        flight.update(camera);
        const auto asked = std::span(flight.fetcher.log).subspan(seen);
        if (asked.size() > 1) ++kinds_of_updates;
        for (size_t k = 1; k < asked.size(); ++k) EXPECT_GE(asked[k - 1].priority, asked[k].priority);
        seen = flight.fetcher.log.size();
    }
    EXPECT_GE(kinds_of_updates, 3u) << "the directory, first what opens tiles, then the rest";
}

TEST(CityStreamer, CountsTheSameBytesWithoutDecoding) {
    const SyntheticCity& city = shared_city();
    StreamerOptions counting;
    counting.decode = false;
    counting.directory_pool = std::make_shared<DirectoryPool>();
    // As a client does that cannot know what hides what.
    Flight drawing(city, test::whole_view()), loading(city, counting), other(city, counting);
    for (int i = 0; i < 10; ++i) {
        const Camera camera = city.camera(100 + 40 * i, 100, 30, 10 * i, -15);
        drawing.update(camera);
        loading.update(camera);
        other.update(camera);
        EXPECT_EQ(drawing.frame.wire_bytes, loading.frame.wire_bytes);
        EXPECT_EQ(drawing.frame.requests, loading.frame.requests);
        EXPECT_EQ(drawing.frame.gpu_bytes_used, loading.frame.gpu_bytes_used);
        EXPECT_EQ(loading.frame.tiles_missing, 0u);
        EXPECT_EQ(other.frame.wire_bytes, loading.frame.wire_bytes);
    }
}

/// Of each drawn tile: the mesh's first word and place.
std::vector<std::array<double, 3>> places_of(const std::vector<TileDraw>& draws) {
    std::vector<std::array<double, 3>> places;
    for (const TileDraw& draw : draws) places.push_back(draw.origin);
    return places;
}

TEST(CityStreamer, WhatNearTilesHideIsNeitherFetchedNorDrawn) {
    const SyntheticCity& city = shared_city();
    uint64_t hidden = 0, bytes = 0, all_bytes = 0;
    for (int i = 0; i < 12; ++i) {
        // Low enough for the ground's waves to hide what lies behind them.
        const Camera camera = city.camera(80 * i, 500, 2, 30 * i, 0);
        Flight seeing(city), plain(city, test::whole_view()), again(city);
        const auto drawn = addresses_of(seeing, seeing.update(camera));
        const auto all = addresses_of(plain, plain.update(camera));
        for (const test::TileAddress& address : drawn) EXPECT_TRUE(all.contains(address));
        EXPECT_EQ(plain.frame.tiles_hidden, 0U);
        EXPECT_EQ(seeing.frame.tiles_missing, 0U);
        EXPECT_LE(seeing.frame.wire_bytes, plain.frame.wire_bytes);
        hidden += all.size() - drawn.size();
        bytes += seeing.frame.wire_bytes;
        all_bytes += plain.frame.wire_bytes;
        // Of a camera alone, whatever was seen before.
        again.update(city.camera(500, 500, 200, 0, -80));
        EXPECT_EQ(places_of(again.update(camera)), places_of(seeing.update(camera)));
    }
    EXPECT_GT(hidden, 10U);
    EXPECT_LT(bytes, all_bytes);
}

TEST(CityStreamer, OfflineFramesDoNotDependOnTheOrderOfArrival) {
    const SyntheticCity& city = shared_city();
    Flight orderly(city), shuffled(city);
    shuffled.fetcher.random_order = true;
    for (int i = 0; i < 12; ++i) {
        const Camera camera = city.camera(80 * i, 500, 25, 30 * i, -15);
        const auto a = addresses_of(orderly, orderly.update(camera));
        const auto& draws = shuffled.update(camera);
        EXPECT_EQ(a, addresses_of(shuffled, draws));
        EXPECT_EQ(orderly.frame.wire_bytes, shuffled.frame.wire_bytes);
        EXPECT_EQ(orderly.frame.requests, shuffled.frame.requests);
    }
}

TEST(CityStreamer, ACityAtTenMillionMetresIsChosenLikeAtTheOrigin) {
    test::SyntheticOptions near_options, far_options;
    near_options.origin_x = near_options.origin_y = 0;
    far_options.origin_x = far_options.origin_y = 78125.0 * 128;
    const SyntheticCity near_city(near_options), far_city(far_options);
    Flight here(near_city), there(far_city);
    for (int i = 0; i < 5; ++i) {
        const size_t a = here.update(near_city.camera(100 * i, 300, 30, 40 * i, -10)).size();
        const size_t b = there.update(far_city.camera(100 * i, 300, 30, 40 * i, -10)).size();
        EXPECT_EQ(a, b);
        EXPECT_EQ(here.frame.wire_bytes, there.frame.wire_bytes);
    }
}

TEST(CityStreamer, SaysWhatIsWrongWithTheDirectory) {
    const SyntheticCity& city = shared_city();
    for (const char* path : {"tileset.json", "subtrees/0/0/0.subtree"}) {
        auto entries = city.entries;
        entries[path].resize(entries[path].size() / 2);
        FakeFetcher fetcher(entries);
        HostLayerStore store(1 << 20, 4096, true);
        const auto opened = CityStreamer::open(fetcher, store, {});
        ASSERT_FALSE(opened);
        EXPECT_NE(opened.error().text().find(path), std::string::npos) << opened.error().text();
    }
}

}  // namespace
}  // namespace citystream::client
