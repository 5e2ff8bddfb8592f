#include "client/stream/request_plan.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "client/cache/host_layer_store.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::Flight;
using test::Layer;
using test::realtime;
using test::SyntheticCity;

/// A directory that is wholly here, of a city of which nothing else is.
struct Planning {
    Planning() : directory(city.manifest, nullptr), store(64u << 20, 4096, false), cache(store, host) {
        add_subtree({});
        knowledge.tiles.resize(directory.nodes().size());
    }
    void add_subtree(test::TileAddress root) {
        const auto& bytes = city.entries.at(subtree_path(root));
        ASSERT_TRUE(directory.add_subtree(bytes, root).ok());
        const auto subtree = tiles::tileset::parse_subtree(bytes, root, city.manifest);
        ASSERT_TRUE(subtree.ok());
        for (const auto& child : subtree->child_subtrees) add_subtree(child);
    }

    /// The root, wanted as what stands in for a view: its whole mesh, its coarsest texture.
    SelectedTile root(const Camera& camera) {
        SelectedTile tile;
        tile.node = 0;
        selector.select(camera, 1, 4096);
        tile.pixels_per_metre = selector.pixels_per_metre(0);
        tile.steps[static_cast<size_t>(Layer::kMesh)] =
            static_cast<uint8_t>(directory.node(0).record->steps(Layer::kMesh).size());
        tile.steps[static_cast<size_t>(Layer::kAtlas)] = 1;
        return tile;
    }
    std::vector<PlannedRequest> plan(const Camera& camera, double tolerance, bool host_room = true) {
        const SelectedTile stand_in = root(camera);
        selection = selector.select(camera, tolerance, 4096);
        tiles = selection.tiles;
        EXPECT_GT(tiles.size(), 3u) << "the test is too easy";
        tiles.push_back(stand_in);
        PlanOptions options;
        options.directory_first = false;
        options.coarse_first = true;
        options.host_room = host_room;
        return plan_requests(directory, knowledge, cache, selection, tiles, 0, camera, options);
    }
    const SelectedTile& tile_of(const PlannedRequest& request) const {
        return *std::find_if(tiles.begin(), tiles.end(),
                             [&](const SelectedTile& tile) { return tile.node == request.node; });
    }
    /// Whether the mesh prefix that the request brings is worth showing.
    bool recognisable(const PlannedRequest& request) const {
        const auto& steps = directory.node(request.node).record->steps(Layer::kMesh);
        return steps[request.to - 1].error * tile_of(request).pixels_per_metre <= kRecognisableShare * camera_height;
    }
    void receive(const PlannedRequest& request) {
        CachedLayer& entry = cache.at(layer_key(request.node, request.layer));
        const auto& steps = directory.node(request.node).record->steps(request.layer);
        for (uint32_t i = request.from; i < request.to; ++i) {
            cache.add_wire(entry, std::vector<std::byte>(steps[i].end - (i > 0 ? steps[i - 1].end : 0)), false);
        }
    }

    SyntheticCity city;
    DirectoryCache directory;
    CityKnowledge knowledge;
    HostMemory host{.budget = 1ull << 30};
    HostLayerStore store;
    LayerCache cache;
    Selector selector{directory, knowledge};
    Selection selection;
    std::vector<SelectedTile> tiles;
    double camera_height = 480;
};

TEST(RequestPlan, WhileNothingCoversTheViewOnlyWhatMakesAPictureOfItIsAskedFor) {
    Planning planning;
    const Camera camera = planning.city.camera(512, 100, 15, 10, -10);
    const auto requests = planning.plan(camera, 0.5);
    ASSERT_FALSE(requests.empty());
    std::map<NodeIndex, int> layers;
    for (const PlannedRequest& request : requests) {
        EXPECT_EQ(request.kind, RequestKind::kLayer);
        EXPECT_NE(request.layer, Layer::kFacade);
        EXPECT_EQ(request.from, 0u);
        EXPECT_NE(request.node, 0u) << "so near, the root would be no picture";
        ++layers[request.node];
        if (request.layer == Layer::kMesh) {
            const bool all = request.to == planning.tile_of(request).steps_of(Layer::kMesh);
            EXPECT_TRUE(all || planning.recognisable(request));
        } else {
            EXPECT_EQ(request.to, 1u);
        }
    }
    EXPECT_EQ(layers.size() + 1, planning.tiles.size()) << "some tile of the view is left out";
    for (const auto& [node, count] : layers) EXPECT_EQ(count, 2);
}

TEST(RequestPlan, CoarsePositionsComeWithTheStepsThatMakeThemRecognisableAndNoMore) {
    Planning planning;
    size_t longer = 0;
    for (const double height : {4.0, 15.0, 60.0}) {
        for (PlannedRequest request : planning.plan(planning.city.camera(512, 100, height, 10, -10), 0.2)) {
            if (request.layer != Layer::kMesh || request.to < 2) continue;
            ++longer;
            --request.to;
            EXPECT_FALSE(planning.recognisable(request)) << "a step less would have done";
        }
    }
    EXPECT_GT(longer, 0u) << "the test is too easy";
}

TEST(RequestPlan, TheRestIsAskedForOnceAllTilesHaveBegun) {
    Planning planning;
    const Camera camera = planning.city.camera(512, 100, 15, 10, -10);
    const auto openings = planning.plan(camera, 0.5);
    for (size_t i = 0; i + 1 < openings.size(); ++i) planning.receive(openings[i]);
    const auto last = planning.plan(camera, 0.5);
    ASSERT_EQ(last.size(), 1u);
    EXPECT_EQ(last.front().node, openings.back().node);
    EXPECT_EQ(last.front().layer, openings.back().layer);

    planning.cache.at(layer_key(last.front().node, last.front().layer)).requested = true;
    EXPECT_TRUE(planning.plan(camera, 0.5).empty()) << "what is under way shares the link with nothing";

    planning.receive(openings.back());
    const auto rest = planning.plan(camera, 0.5);
    const auto has = [&](auto&& what) { return std::any_of(rest.begin(), rest.end(), what); };
    EXPECT_TRUE(has([](const PlannedRequest& r) { return r.from > 0; }));
    EXPECT_TRUE(has([](const PlannedRequest& r) { return r.layer == Layer::kFacade; }));
    EXPECT_TRUE(has([](const PlannedRequest& r) { return r.kind == RequestKind::kFacadeIndex; }));
    EXPECT_TRUE(has([](const PlannedRequest& r) { return r.node == 0 && r.kind == RequestKind::kLayer; }))
        << "the root, to have something to fall back to";
}

TEST(RequestPlan, OfAViewFromFarTheRootComesFirstWhereItIsMuchSmallerThanTheView) {
    Planning planning;
    const Camera far = planning.city.camera(512, 512, 1500, 0, -89);
    const auto requests = planning.plan(far, 0.05);
    ASSERT_EQ(requests.size(), 2u);
    for (const PlannedRequest& request : requests) EXPECT_EQ(request.node, 0u);
    for (const PlannedRequest& request : requests) planning.receive(request);
    const auto rest = planning.plan(far, 0.05);
    EXPECT_GT(rest.size(), 2 * planning.selection.tiles.size()) << "the view is covered: all may be asked for";
    // What has not begun still comes before what refines.
    const auto refines = [](const PlannedRequest& r) { return r.kind == RequestKind::kLayer && r.from > 0; };
    const auto first_refining = std::find_if(rest.begin(), rest.end(), refines);
    EXPECT_TRUE(std::all_of(first_refining, rest.end(), [&](const PlannedRequest& r) {
        return refines(r) || r.layer == Layer::kFacade || r.kind != RequestKind::kLayer;
    }));
}

TEST(RequestPlan, WithoutRoomBesideTheViewTheRootDoesNotGoFirst) {
    Planning planning;
    const auto requests = planning.plan(planning.city.camera(512, 512, 1500, 0, -89), 0.05, false);
    EXPECT_EQ(requests.size(), 2 * planning.selection.tiles.size());
}

TEST(RequestPlan, ARealtimeFlightAsksForNothingElseWhileItsViewHasGaps) {
    const SyntheticCity city;
    Flight flight(city, realtime());
    flight.fetcher.per_poll = 1;
    const auto waits_for_cover = [](const FetchRequest& request) {
        return request.path.starts_with("facades/") || (request.path.starts_with("tiles/") && request.offset > 0);
    };
    size_t gaps = 0, rest = 0;
    for (int i = 0; i < 300; ++i) {
        const size_t before = flight.fetcher.log.size();
        flight.update(city.camera(512, 100, 15, 10, -10));
        const auto asked = std::span(flight.fetcher.log).subspan(before);
        const auto count = static_cast<size_t>(std::count_if(asked.begin(), asked.end(), waits_for_cover));
        EXPECT_TRUE(i > 0 ||
                    std::none_of(asked.begin(), asked.end(),
                                 [](const FetchRequest& request) { return request.path.starts_with("tiles/"); }))
            << "tiles are asked for that are not chosen once the directory is here";
        if (flight.frame.tiles_missing > 0) {
            EXPECT_EQ(count, 0u) << "update " << i;
            ++gaps;
        }
        rest += count;
    }
    EXPECT_GT(gaps, 5u) << "all came at once: the test is too easy";
    EXPECT_GT(rest, 0u);
    EXPECT_EQ(flight.frame.tiles_missing, 0u);
    EXPECT_GT(flight.frame.tiles_wanted, 3u);
}

}  // namespace
}  // namespace citystream::client
