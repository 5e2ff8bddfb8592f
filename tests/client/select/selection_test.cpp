#include "client/select/selection.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::Layer;
using test::SyntheticCity;
using test::TileAddress;
using test::TileRecord;

/// A directory with every subtree loaded, and what follows from knowing all.
struct World {
    explicit World(const SyntheticCity& where) : city(where), directory(where.manifest, nullptr) {
        for (uint32_t level = 0; level < city.manifest.levels; level += city.manifest.subtree_levels) {
            for (const auto& [address, record] : city.tiles) {
                if (address.level != level) continue;
                EXPECT_TRUE(directory.add_subtree(city.entries.at(subtree_path(address)), address));
            }
        }
        knowledge.tiles.resize(directory.nodes().size());
        knowledge.dictionary.learn(city.maps);
        for (NodeIndex i = 0; i < directory.nodes().size(); ++i) {
            node_of[directory.node(i).record->address] = i;
            const auto maps = city.maps_of_tile.find(directory.node(i).record->address);
            if (maps == city.maps_of_tile.end()) continue;
            knowledge.tiles[i].facade_maps_known = true;
            knowledge.tiles[i].facade_maps = maps->second;
            knowledge.tiles[i].placements = city.placements_of_tile.at(maps->first);
        }
    }
    const SyntheticCity& city;
    DirectoryCache directory;
    CityKnowledge knowledge;
    std::map<TileAddress, NodeIndex> node_of;
};

World& world() {
    static const SyntheticCity city;
    static World instance(city);
    return instance;
}

/// The rule read straight from DESIGN.md: a visible tile is drawn when no ancestor is good enough and it is good enough
/// itself, or a leaf.
bool chosen_by_the_rule(const SyntheticCity& city, const Camera& camera, const TileRecord& record, double tolerance) {
    const auto error = [&](const TileRecord& tile) {
        const double d = std::max(camera.distance_to(tile.bounds, city.origin()), camera.near_plane);
        return double{tile.geometric_error} * camera.height / (2 * d * std::tan(camera.fov_y / 2));
    };
    if (!camera.sees(record.bounds, city.origin())) return false;
    for (TileAddress up = record.address; up.level > 0;) {
        up = up.parent();
        if (error(city.tile(up)) <= tolerance || !camera.sees(city.tile(up).bounds, city.origin())) return false;
    }
    return record.address.level + 1 == city.manifest.levels || error(record) <= tolerance;
}

/// What a selection without a picture has and one with it has not.
std::set<TileAddress> left_out(const World& all, const Selection& without, const Selection& with) {
    std::set<TileAddress> out;
    for (const SelectedTile& tile : without.tiles) out.insert(all.directory.node(tile.node).record->address);
    for (const SelectedTile& tile : with.tiles) out.erase(all.directory.node(tile.node).record->address);
    return out;
}

TEST(Selection, TilesBehindThePictureAreLeftOutAndNoOthers) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    const Camera camera = all.city.camera(512, 10, 20, 0, 0);
    const Selection without = selector.select(camera, 1, 4096);
    DepthPicture picture;
    picture.begin(camera);
    // A wall across the street, 200 m ahead, from 200 m to the left to 200 m to the right.
    const auto [x, y] = all.city.origin();
    const std::vector<std::array<double, 3>> wall = {
        {x + 312, y + 210, -100}, {x + 712, y + 210, -100}, {x + 712, y + 210, 300}, {x + 312, y + 210, 300}};
    picture.add(wall);
    picture.finish();
    selector.look_past(&picture, std::numeric_limits<double>::infinity());
    const Selection with = selector.select(camera, 1, 4096);
    const auto gone = left_out(all, without, with);
    EXPECT_GT(gone.size(), 3U);
    EXPECT_GT(with.tiles.size(), 3U);
    EXPECT_GT(with.hidden, 0U);
    EXPECT_EQ(without.hidden, 0U);
    for (const TileAddress& address : gone)
        EXPECT_TRUE(picture.hides(all.city.tile(address).bounds, all.city.origin()));
    for (const SelectedTile& tile : with.tiles) {
        EXPECT_FALSE(picture.hides(all.directory.node(tile.node).record->bounds, all.city.origin()));
        EXPECT_TRUE(selector.visible(tile.node));
    }
    selector.look_past(nullptr, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(left_out(all, without, selector.select(camera, 1, 4096)).empty());
}

TEST(Selection, TilesBeyondTheHorizonAreLeftOutAndItSaysSo) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    const Camera camera = all.city.camera(512, 10, 20, 0, -5);
    const Selection everything = selector.select(camera, 1, 4096);
    EXPECT_TRUE(std::isinf(everything.nearest_beyond));
    size_t before = 0;
    for (double horizon = 16; horizon < 4096; horizon *= 4) {
        selector.look_past(nullptr, horizon);
        const Selection near = selector.select(camera, 1, 4096);
        EXPECT_EQ(std::isfinite(near.nearest_beyond), near.tiles.size() < everything.tiles.size());
        EXPECT_GT(near.nearest_beyond, horizon);
        EXPECT_GE(near.tiles.size(), before);
        before = near.tiles.size();
        for (const SelectedTile& tile : near.tiles) {
            const auto& bounds = all.directory.node(tile.node).record->bounds;
            EXPECT_LE(camera.distance_to(bounds, all.city.origin()), horizon);
        }
    }
    EXPECT_EQ(before, everything.tiles.size());
}

TEST(Selection, EqualsTheRuleReadTileByTile) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-100, 1124), height(5, 900), turn(0, 360), tolerance(0.3, 30);
    size_t total = 0;
    for (int i = 0; i < 200; ++i) {
        const Camera camera = all.city.camera(place(random), place(random), height(random), turn(random), -30);
        const double pixels = tolerance(random);
        const Selection selection = selector.select(camera, pixels, 4096);
        std::set<TileAddress> chosen, expected;
        for (const SelectedTile& tile : selection.tiles) chosen.insert(all.directory.node(tile.node).record->address);
        for (const auto& [address, record] : all.city.tiles) {
            if (chosen_by_the_rule(all.city, camera, record, pixels)) expected.insert(address);
        }
        EXPECT_EQ(chosen, expected);
        EXPECT_EQ(chosen.size(), selection.tiles.size());
        EXPECT_TRUE(selection.subtrees.empty());
        total += chosen.size();
    }
    EXPECT_GT(total, 250u);
}

/// Whether a point projects into the picture, read from the camera's axes alone.
bool in_picture(const Camera& camera, const std::array<double, 3>& point) {
    std::array<double, 3> to{};
    for (size_t a = 0; a < 3; ++a) to[a] = point[a] - camera.position[a];
    const auto along = [&](const std::array<double, 3>& axis) {
        return to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2];
    };
    const double depth = along(camera.forward), high = depth * std::tan(camera.fov_y / 2);
    return depth > camera.near_plane && std::abs(along(camera.up)) < high &&
           std::abs(along(camera.right)) < high * camera.width / camera.height;
}

/// Whether any of 9 x 9 x 3 points of a tile's box is in the picture.
bool has_point_in_picture(const Camera& camera, const TileRecord& tile, const std::array<double, 2>& origin) {
    const auto& [low, high] = std::tie(tile.bounds.min, tile.bounds.max);
    for (int i = 0; i < 9 * 9 * 3; ++i) {
        const std::array<double, 3> share = {i % 9 / 8.0, i / 9 % 9 / 8.0, i / 81 / 2.0};
        std::array<double, 3> point{};
        for (size_t a = 0; a < 3; ++a) point[a] = low[a] + share[a] * (high[a] - low[a]) + (a < 2 ? origin[a] : 0);
        if (in_picture(camera, point)) return true;
    }
    return false;
}

TEST(Selection, NothingInThePictureIsDroppedFromAThousandCameras) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    std::mt19937 random(21);
    std::uniform_real_distribution<double> place(-300, 1324), height(2, 400), turn(0, 360), pitch(-60, 20);
    size_t seen = 0, left_out = 0;
    for (int i = 0; i < 1000; ++i) {
        const Camera camera =
            all.city.camera(place(random), place(random), height(random), turn(random), pitch(random), 50);
        std::set<TileAddress> chosen;
        for (const SelectedTile& tile : selector.select(camera, 1, 4096).tiles)
            chosen.insert(all.directory.node(tile.node).record->address);
        for (const auto& [address, record] : all.city.tiles) {
            if (address.level + 1 != all.city.manifest.levels) continue;
            if (!has_point_in_picture(camera, record, all.city.origin())) {
                ++left_out;
                continue;
            }
            ++seen;
            TileAddress drawn = address;
            while (drawn.level > 0 && !chosen.contains(drawn)) drawn = drawn.parent();
            ASSERT_TRUE(chosen.contains(drawn)) << "camera " << i << ", tile " << address.x << ", " << address.y;
        }
    }
    EXPECT_GT(seen, 5000U);
    EXPECT_GT(left_out, 5000U);
}

TEST(Selection, TakesTheShortestPrefixBelowTheTolerance) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    uint32_t partial = 0, facades = 0, no_facades = 0;
    for (double z = 10; z < 1500; z *= 1.5) {
        const Camera camera = all.city.camera(400, 400, z, 30, -40);
        for (const SelectedTile& tile : selector.select(camera, 1.0, 4096).tiles) {
            const TileRecord& record = *all.directory.node(tile.node).record;
            const uint32_t steps = tile.steps_of(Layer::kAtlas);
            const auto& table = record.steps(Layer::kAtlas);
            ASSERT_GE(steps, 1u);
            ASSERT_LE(steps, table.size());
            const bool last = steps == table.size();
            EXPECT_TRUE(last || table[steps - 1].error * tile.pixels_per_metre <= 1.0);
            if (steps > 1) {
                EXPECT_GT(table[steps - 2].error * tile.pixels_per_metre, 1.0);
            }
            partial += last ? 0 : 1;
            if (record.steps(Layer::kFacade).empty()) continue;
            const bool shows = record.flat_facade_error * tile.pixels_per_metre > 1.0;
            EXPECT_EQ(tile.steps_of(Layer::kFacade), shows ? 1 : 0);
            ++(shows ? facades : no_facades);
        }
    }
    EXPECT_GT(partial, 0u);
    EXPECT_GT(facades, 0u);
    EXPECT_GT(no_facades, 0u);
}

TEST(Selection, TakesTheFirstStepOfAMeshThatItsNearestCellMayStopAt) {
    World& all = world();
    std::map<uint32_t, uint32_t> tiles_by_steps;
    for (const double pixels : {0.25, 1.0, 4.0}) {
        Selector selector(all.directory, all.knowledge, {}, {}, pixels);
        for (double z = 10; z < 1500; z *= 1.5) {
            const Camera camera = all.city.camera(400, 400, z, 30, -40);
            const Selection chosen = selector.select(camera, 1.0, 4096);
            EXPECT_EQ(chosen.position_tolerance, pixels);
            for (const SelectedTile& tile : chosen.tiles) {
                const TileRecord& record = *all.directory.node(tile.node).record;
                const auto dropped = dropped_bits(record.steps(Layer::kMesh));
                const uint32_t granted =
                    granted_in(position_rule(camera, pixels), record.bounds, all.city.manifest.origin);
                const uint32_t steps = tile.steps_of(Layer::kMesh);
                ASSERT_GE(steps, 1u);
                const bool last = steps == record.steps(Layer::kMesh).size();
                EXPECT_TRUE(last || dropped[steps - 1] <= granted);
                EXPECT_TRUE(steps == 1 || dropped[steps - 2] > granted);
                ++tiles_by_steps[steps];
            }
        }
    }
    EXPECT_EQ(tiles_by_steps.size(), 3u) << "some number of steps is never chosen: the test is too easy";
}

TEST(Selection, ABudgetRaisesTheToleranceOfPositionsToo) {
    World& all = world();
    Selector selector(all.directory, all.knowledge, {}, {}, 0.5);
    const Camera camera = all.city.camera(300, 300, 20, 30, -20);
    const uint64_t whole = selector.select(camera, 1.0, 1024).cost.slots;
    const Selection bound = selector.select_within(camera, 1.0, {1024, whole / 2, ~uint64_t{0}, 0});
    ASSERT_GT(bound.tolerance, 1.0);
    EXPECT_EQ(bound.position_tolerance, 0.5 * bound.tolerance);
    EXPECT_EQ(bound.positions.drop.distance_per_unit,
              position_rule(camera, 0.5 * bound.tolerance).drop.distance_per_unit);
}

/// The rule for levels read straight from its statement: of each wall (which run along x here) the coarsest level whose
/// texels project below `pixels`.
std::set<MapPiece> pieces_by_the_rule(const SyntheticCity& city, const Camera& camera, const TileRecord& tile,
                                      double pixels) {
    std::set<MapPiece> pieces;
    const GridPoint origin = city.manifest.tile_origin(tile);
    for (const codec::facade::Placement& wall : city.placements_of_tile.at(tile.address)) {
        const auto outside = [&](size_t axis, int64_t low, int64_t length) {
            const double begin = to_metres(low), end = to_metres(low + length);
            return std::max({0.0, begin - camera.position[axis], camera.position[axis] - end});
        };
        const double distance =
            std::hypot(outside(0, origin.x + wall.origin[0], wall.along[0]), outside(1, origin.y + wall.origin[1], 0),
                       outside(2, origin.z + wall.origin[2], wall.height));
        const double pixels_per_metre = camera.height / (2 * distance * std::tan(camera.fov_y / 2));
        const auto& map = city.maps[wall.map];
        uint32_t level = 0;
        while (level + 1 < map.level_count && map.level[level].texel_cm * pixels_per_metre > 100 * pixels) ++level;
        pieces.insert(map_piece(wall.map, level));
    }
    return pieces;
}

TEST(Selection, CountsEveryLayerInSlotsAndEveryLevelOfAMapOnce) {
    World& all = world();
    Selector selector(all.directory, all.knowledge, {std::nullopt, std::nullopt, 1.0});
    constexpr double kTolerance = 0.25;
    const Camera camera = all.city.camera(200, 100, 20, -20, -20);
    const Selection selection = selector.select(camera, kTolerance, 1000);
    uint64_t slots = 0, wire = 0;
    std::set<MapPiece> pieces;
    for (const SelectedTile& tile : selection.tiles) {
        const TileRecord& record = *all.directory.node(tile.node).record;
        for (size_t layer = 0; layer < tiles::tileset::kLayerCount; ++layer) {
            uint64_t bytes = 0;
            for (uint32_t i = 0; i < tile.steps[layer]; ++i) bytes += record.layers[layer][i].decoded_bytes;
            slots += (bytes + 999) / 1000;
            if (tile.steps[layer] > 0) wire += record.layers[layer][tile.steps[layer] - 1].end;
        }
        if (!tile.has_relief()) continue;
        const std::set<MapPiece> wanted = pieces_by_the_rule(all.city, camera, record, kTolerance);
        EXPECT_EQ(std::set<MapPiece>(tile.pieces.begin(), tile.pieces.end()), wanted);
        EXPECT_EQ(tile.pieces.size(), wanted.size());
        pieces.insert(wanted.begin(), wanted.end());
    }
    std::set<uint32_t> maps;
    for (const MapPiece piece : pieces) {
        slots += (all.knowledge.dictionary.resident_bytes(piece) + 999) / 1000;
        wire += all.knowledge.dictionary.wire_bytes(piece);
        maps.insert(map_of(piece));
    }
    EXPECT_LT(maps.size(), pieces.size()) << "no map is wanted in two levels: the test is too easy";
    EXPECT_EQ(selection.cost.slots, slots);
    EXPECT_EQ(selection.cost.wire_bytes, wire);
}

TEST(Selection, ReliefBelowItsOwnToleranceIsFlatAndMapsFollowTheCommonOne) {
    World& all = world();
    const Camera camera = all.city.camera(300, 250, 10, 0, 0);
    uint32_t shown_before = ~0u;
    for (const double pixels : {0.25, 0.5, 1.0}) {
        Selector selector(all.directory, all.knowledge, {pixels, std::nullopt, 0.25});
        uint32_t shown = 0;
        for (const SelectedTile& tile : selector.select(camera, 1.0, 4096).tiles) {
            const TileRecord& record = *all.directory.node(tile.node).record;
            const bool shows = record.flat_facade_error * tile.pixels_per_metre > pixels;
            EXPECT_EQ(tile.has_relief(), shows);
            shown += shows ? 1 : 0;
            if (!shows) continue;
            const std::set<MapPiece> wanted = pieces_by_the_rule(all.city, camera, record, 0.25);
            EXPECT_EQ(std::set<MapPiece>(tile.pieces.begin(), tile.pieces.end()), wanted);
        }
        EXPECT_LT(shown, shown_before);
        shown_before = shown;
    }
    EXPECT_GT(shown_before, 0u);
}

TEST(Selection, ABudgetRaisesBothTolerances) {
    World& all = world();
    Selector selector(all.directory, all.knowledge, {0.5, std::nullopt, 0.25});
    const Camera camera = all.city.camera(300, 300, 20, 30, -20);
    const uint64_t whole = selector.select(camera, 1.0, 1024).cost.slots;
    const Selection bound = selector.select_within(camera, 1.0, {1024, whole / 2, ~uint64_t{0}, 0});
    ASSERT_GT(bound.tolerance, 1.0);
    for (const SelectedTile& tile : bound.tiles) {
        const double relief = all.directory.node(tile.node).record->flat_facade_error * tile.pixels_per_metre;
        EXPECT_EQ(tile.has_relief(), relief > 0.5 * bound.tolerance);
        if (!tile.has_relief()) continue;
        const TileRecord& record = *all.directory.node(tile.node).record;
        const std::set<MapPiece> wanted = pieces_by_the_rule(all.city, camera, record, 0.25 * bound.tolerance);
        EXPECT_EQ(std::set<MapPiece>(tile.pieces.begin(), tile.pieces.end()), wanted);
    }
}

TEST(Selection, TexelsFollowTheirOwnToleranceAndNothingElseDoes) {
    World& all = world();
    Selector common(all.directory, all.knowledge);
    uint32_t fewer = 0;
    for (double z = 10; z < 1500; z *= 1.5) {
        const Camera camera = all.city.camera(400, 400, z, 30, -40);
        const Selection plain = common.select(camera, 1.0, 4096);
        for (const double pixels : {0.25, 1.0, 4.0}) {
            Selector selector(all.directory, all.knowledge, {}, pixels);
            const Selection chosen = selector.select(camera, 1.0, 4096);
            ASSERT_EQ(chosen.tiles.size(), plain.tiles.size());
            for (size_t i = 0; i < chosen.tiles.size(); ++i) {
                const SelectedTile& tile = chosen.tiles[i];
                const auto& steps = all.directory.node(tile.node).record->steps(Layer::kAtlas);
                EXPECT_EQ(tile.node, plain.tiles[i].node);
                EXPECT_EQ(tile.steps_of(Layer::kMesh), plain.tiles[i].steps_of(Layer::kMesh));
                EXPECT_EQ(tile.pieces, plain.tiles[i].pieces);
                EXPECT_EQ(tile.steps_of(Layer::kAtlas),
                          shortest_prefix(steps, static_cast<uint32_t>(steps.size()), tile.pixels_per_metre, pixels));
                fewer += tile.steps_of(Layer::kAtlas) < plain.tiles[i].steps_of(Layer::kAtlas) ? 1 : 0;
            }
        }
    }
    EXPECT_GT(fewer, 0u) << "no tile has a step between the tolerances: the test is too easy";
}

TEST(Selection, ABudgetRaisesTheToleranceOfTexelsToo) {
    World& all = world();
    Selector selector(all.directory, all.knowledge, {}, 0.5);
    const Camera camera = all.city.camera(300, 300, 20, 30, -20);
    const uint64_t whole = selector.select(camera, 1.0, 1024).cost.slots;
    const Selection bound = selector.select_within(camera, 1.0, {1024, whole / 2, ~uint64_t{0}, 0});
    ASSERT_GT(bound.tolerance, 1.0);
    for (const SelectedTile& tile : bound.tiles) {
        const auto& steps = all.directory.node(tile.node).record->steps(Layer::kAtlas);
        EXPECT_EQ(tile.steps_of(Layer::kAtlas), shortest_prefix(steps, static_cast<uint32_t>(steps.size()),
                                                                tile.pixels_per_metre, 0.5 * bound.tolerance));
    }
}

TEST(Selection, RaisesTheToleranceToTheSmallestStepThatFitsTheBudget) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    const Camera camera = all.city.camera(512, 100, 30, 0, -15);
    const uint64_t whole = selector.select(camera, 1.0, 1024).cost.slots;
    double before = 1.0;
    for (uint64_t slots = whole; slots > 12; slots = slots * 2 / 3) {
        const Selection selection = selector.select_within(camera, 1.0, {1024, slots, ~uint64_t{0}, 0});
        EXPECT_TRUE(selection.fits);
        EXPECT_LE(selection.cost.slots, slots);
        EXPECT_GE(selection.tolerance, before);
        const double k = 4 * std::log2(selection.tolerance);
        EXPECT_NEAR(k, std::round(k), 1e-9) << "off the grid of tolerances";
        if (selection.tolerance > 1.0) {
            const double finer = std::exp2((std::round(k) - 1) / 4);
            EXPECT_GT(selector.select(camera, finer, 1024).cost.slots, slots) << "a finer choice would have fitted";
        }
        before = selection.tolerance;
    }
    EXPECT_GT(before, 1.0);
}

TEST(Selection, ReliefThatNoBudgetHoldsIsLeftFlatFarTilesFirstInsteadOfCoarseningAll) {
    const SyntheticCity& city = world().city;
    World converted(city);
    for (MapPiece piece = 0; map_of(piece) < city.maps.size(); piece = converted.knowledge.dictionary.next(piece)) {
        converted.knowledge.dictionary.learn_size(piece, 400'000);
    }
    const Camera camera = city.camera(200, 100, 20, -20, -20);
    constexpr double kTolerance = 0.25;
    Selector selector(converted.directory, converted.knowledge);
    const Selection whole = selector.select(camera, kTolerance, 1024);
    Selector flat_selector(converted.directory, converted.knowledge, {1e9, std::nullopt, 0.25});
    const Selection flat = flat_selector.select(camera, kTolerance, 1024);
    const auto with_relief = [](const Selection& selection) {
        return std::count_if(selection.tiles.begin(), selection.tiles.end(),
                             [](const SelectedTile& tile) { return tile.has_relief(); });
    };
    ASSERT_GT(with_relief(whole), 3);
    const uint64_t budget = flat.cost.slots + (whole.cost.slots - flat.cost.slots) / 3;
    const Selection bound = selector.select_within(camera, kTolerance, {1024, budget, ~uint64_t{0}, 0});
    EXPECT_TRUE(bound.fits);
    EXPECT_TRUE(bound.relief_left_out);
    EXPECT_EQ(bound.tolerance, kTolerance) << "mesh and atlas fit as they are";
    EXPECT_EQ(bound.tiles.size(), whole.tiles.size());
    EXPECT_LE(bound.cost.slots, budget);
    EXPECT_GT(bound.cost.slots, flat.cost.slots);
    EXPECT_GT(with_relief(bound), 0);
    EXPECT_LT(with_relief(bound), with_relief(whole));
    const auto nearest = std::max_element(
        bound.tiles.begin(), bound.tiles.end(),
        [](const SelectedTile& a, const SelectedTile& b) { return a.pixels_per_metre < b.pixels_per_metre; });
    EXPECT_TRUE(nearest->has_relief());
    EXPECT_FALSE(selector.select_within(camera, kTolerance, {1024, whole.cost.slots, ~uint64_t{0}, 0}).relief_left_out);
}

TEST(Selection, HoldsTheHostBudgetToo) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    const Camera camera = all.city.camera(512, 100, 30, 0, -15);
    const Selection free = selector.select(camera, 1.0, 1024);
    const uint64_t limit = free.cost.wire_bytes / 3;
    const Selection bound = selector.select_within(camera, 1.0, {1024, ~uint64_t{0}, limit, 100});
    EXPECT_LE(bound.cost.wire_bytes + 100 * bound.cost.layers + bound.cost.largest_scratch, limit);
    EXPECT_GT(bound.tolerance, 1.0);
}

World& lit_world() {
    static const SyntheticCity city = [] {
        test::SyntheticOptions options;
        options.chart_size = 8;
        options.facades = false;
        options.light = 5;
        return SyntheticCity(options);
    }();
    static World instance(city);
    return instance;
}

const std::vector<tiles::tileset::StepRecord>& light_steps(const World& lit, const SelectedTile& tile) {
    return lit.directory.node(tile.node).record->steps(Layer::kRadiance);
}

uint8_t light_of(const SelectedTile& tile) {
    return tile.steps_of(Layer::kRadiance);
}

TEST(Selection, LightTakesTheShortestPrefixWithinItsToleranceWhateverTheDistance) {
    const World& lit = lit_world();
    const Camera camera = lit.city.camera(512, 100, 30, 0, -15);
    std::set<uint8_t> seen;
    for (const double tolerance : {0.0, 0.3, 0.5, 0.55, 1.0}) {
        Selector selector(lit.directory, lit.knowledge, {}, {}, {}, tolerance);
        const Selection selection = selector.select(camera, 1.0, 1024);
        EXPECT_EQ(selection.light_tolerance, tolerance);
        EXPECT_FALSE(selection.light_left_out);
        for (const SelectedTile& tile : selection.tiles) {
            const auto& steps = light_steps(lit, tile);
            const uint8_t taken = light_of(tile);
            ASSERT_TRUE(taken >= 1 && taken <= steps.size());
            EXPECT_LE(steps[taken - 1].error, tolerance);
            EXPECT_TRUE(taken == 1 || steps[taken - 2].error > tolerance);
            seen.insert(taken);
        }
    }
    EXPECT_EQ(seen.size(), 3U) << "some prefix was never wanted: the test is too easy";
    Selector none(lit.directory, lit.knowledge);
    const Selection without = none.select(camera, 1.0, 1024);
    EXPECT_EQ(without.light_tolerance, 0);
    for (const SelectedTile& tile : without.tiles) EXPECT_EQ(light_of(tile), 0);
}

TEST(Selection, LightThatCannotBeHadIsNotWanted) {
    World lit(lit_world().city);
    Selector selector(lit.directory, lit.knowledge, {}, {}, {}, 0.0);
    const Camera camera = lit.city.camera(512, 100, 30, 0, -15);
    const NodeIndex some = selector.select(camera, 1.0, 1024).tiles[0].node;
    for (const uint8_t usable : {uint8_t{0}, uint8_t{1}, uint8_t{2}}) {
        lit.knowledge.tiles[some].usable_steps[static_cast<size_t>(Layer::kRadiance)] = usable;
        const Selection selection = selector.select(camera, 1.0, 1024);
        EXPECT_EQ(selection.tiles[0].node, some);
        EXPECT_EQ(light_of(selection.tiles[0]), usable);
        EXPECT_EQ(light_of(selection.tiles[1]), 3);
    }
}

uint64_t light_slots(const World& lit, const SelectedTile& tile, uint32_t steps) {
    return (decoded_prefix_bytes(light_steps(lit, tile), steps) + 1023) / 1024;
}

TEST(Selection, LightCostsWhatItTakesAndIsRaisedWithTheTolerance) {
    const World& lit = lit_world();
    const Camera camera = lit.city.camera(512, 100, 30, 0, -15);
    Selector dark(lit.directory, lit.knowledge), light(lit.directory, lit.knowledge, {}, {}, {}, 0.06);
    const Selection without = dark.select(camera, 1.0, 1024), with = light.select(camera, 1.0, 1024);
    uint64_t wire = 0, slots = 0;
    for (const SelectedTile& tile : with.tiles) {
        wire += light_steps(lit, tile)[light_of(tile) - 1U].end;
        slots += light_slots(lit, tile, light_of(tile));
    }
    EXPECT_EQ(with.cost.wire_bytes, without.cost.wire_bytes + wire);
    EXPECT_EQ(with.cost.slots, without.cost.slots + slots);
    EXPECT_EQ(with.cost.layers, without.cost.layers + with.tiles.size());
    EXPECT_GE(with.cost.largest_scratch, without.cost.largest_scratch);
    const Selection bound = light.select_within(camera, 1.0, {1024, without.cost.slots / 3, ~uint64_t{0}, 0});
    EXPECT_GT(bound.tolerance, 1.0);
    EXPECT_DOUBLE_EQ(bound.light_tolerance, 0.06 * bound.tolerance);
}

TEST(Selection, LightTakesOnlyWhatTheRestLeavesAndOneStepForEachTileFirst) {
    const World& lit = lit_world();
    const Camera camera = lit.city.camera(512, 100, 30, 0, -15);
    Selector dark(lit.directory, lit.knowledge), light(lit.directory, lit.knowledge, {}, {}, {}, 0.0);
    const Selection without = dark.select(camera, 1.0, 1024), whole = light.select(camera, 1.0, 1024);
    const uint64_t tiles = whole.tiles.size();
    uint64_t before = 0;
    for (uint64_t spare = 0; without.cost.slots + spare <= whole.cost.slots; ++spare) {
        const Selection bound = light.select_within(camera, 1.0, {1024, without.cost.slots + spare, ~uint64_t{0}, 0});
        EXPECT_EQ(bound.tolerance, 1.0);
        ASSERT_EQ(bound.tiles.size(), tiles);
        EXPECT_LE(bound.cost.slots, without.cost.slots + spare);
        uint64_t lit_tiles = 0, finished = 0, all_steps = 0, left = spare;
        double finished_least = 1e9, unfinished_most = 0;
        for (const SelectedTile& tile : bound.tiles) {
            lit_tiles += light_of(tile) > 0 ? 1 : 0;
            all_steps += light_of(tile);
            finished += light_of(tile) == 3 ? 1 : 0;
            left -= light_slots(lit, tile, light_of(tile));
            if (light_of(tile) == 3) finished_least = std::min(finished_least, tile.pixels_per_metre);
            if (light_of(tile) != 3) unfinished_most = std::max(unfinished_most, tile.pixels_per_metre);
        }
        EXPECT_TRUE(finished == 0 || lit_tiles == tiles) << "some have all, others nothing";
        EXPECT_TRUE(lit_tiles == tiles || left == 0) << "one step takes one slot";
        EXPECT_GE(finished_least, unfinished_most) << "a farther tile has more light than a nearer one";
        EXPECT_EQ(bound.light_left_out, all_steps < 3 * tiles);
        EXPECT_GE(all_steps, before);
        before = all_steps;
    }
    EXPECT_EQ(before, 3 * tiles);
    const uint64_t host = without.cost.wire_bytes + without.cost.largest_scratch;
    const Selection bound = light.select_within(camera, 1.0, {1024, ~uint64_t{0}, host, 0});
    EXPECT_EQ(bound.tolerance, 1.0);
    EXPECT_TRUE(bound.light_left_out);
    EXPECT_LE(bound.cost.wire_bytes + bound.cost.largest_scratch, host);
}

TEST(Selection, LeavesFarTilesOutOnlyWhenNothingCoarserIsLeft) {
    World& all = world();
    Selector selector(all.directory, all.knowledge);
    const Selection none =
        selector.select_within(all.city.camera(512, 100, 30, 0, -15), 1.0, {1024, 1, ~uint64_t{0}, 0});
    EXPECT_FALSE(none.fits);
    EXPECT_LE(none.cost.slots, 1u);
}

TEST(Selection, DrawsTheParentInsteadOfAllChildrenWhenOneCannotBeHad) {
    const SyntheticCity& city = world().city;
    World damaged(city);
    const NodeIndex bad = damaged.node_of.at({3, 2, 2});
    damaged.knowledge.tiles[bad].usable_steps[static_cast<size_t>(Layer::kAtlas)] = 0;
    Selector selector(damaged.directory, damaged.knowledge);
    const Selection selection = selector.select(city.camera(300, 200, 20, 10, -20), 1.0, 4096);
    std::set<TileAddress> chosen;
    for (const SelectedTile& tile : selection.tiles) chosen.insert(damaged.directory.node(tile.node).record->address);
    EXPECT_TRUE(chosen.contains({2, 1, 1}));
    for (uint32_t i = 0; i < 4; ++i) EXPECT_FALSE(chosen.contains(TileAddress{2, 1, 1}.child(i)));
}

TEST(Selection, ReachesOnlyTheSubtreesThatTheViewNeeds) {
    const SyntheticCity& city = world().city;
    DirectoryCache directory(city.manifest, nullptr);
    ASSERT_TRUE(directory.add_subtree(city.entries.at("subtrees/0/0/0.subtree"), {}));
    CityKnowledge knowledge;
    knowledge.tiles.resize(directory.nodes().size());
    Selector selector(directory, knowledge);
    EXPECT_TRUE(selector.select(city.camera(512, 512, 90'000, 0, -89), 1.0, 4096).subtrees.empty());
    const Selection near = selector.select(city.camera(50, 50, 20, 225, -30), 1.0, 4096);
    EXPECT_FALSE(near.subtrees.empty());
    EXPECT_LT(near.subtrees.size(), 16u);
    EXPECT_FALSE(near.tiles.empty()) << "what is known is drawn meanwhile";
}

TEST(Selection, ThousandsOfTilesAreChosenInMilliseconds) {
    test::SyntheticOptions options;
    options.levels = 7;
    options.subtree_levels = 7;
    options.chart_size = 4;
    options.facades = false;
    const SyntheticCity city(options);
    const World all(city);
    Selector selector(all.directory, all.knowledge);
    const Camera camera = city.camera(512, -20, 60, 0, -20);
    double best = 1e9;
    size_t tiles = 0;
    for (int i = 0; i < 5; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        tiles = selector.select(camera, 0.01, 4096).tiles.size();
        best =
            std::min(best, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    }
    EXPECT_GT(tiles, 2000u);
    EXPECT_LT(best, 50.0)
        << "milliseconds";  // far above what is measured: a guard against the quadratic, not a benchmark
    RecordProperty("tiles", static_cast<int>(tiles));
    std::printf("%zu tiles selected in %.3f ms\n", tiles, best);
}

}  // namespace
}  // namespace citystream::client
