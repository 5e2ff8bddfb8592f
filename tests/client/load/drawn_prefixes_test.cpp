#include "client/load/drawn_prefixes.h"

#include <gtest/gtest.h>

#include "tests/client/load/tiny_city.h"
#include "tests/client/stream/streamer_flight.h"

namespace citystream::client {
namespace {

using test::kStepBytes;
using tiles::tileset::Layer;
using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;

class DrawnPrefixesTest : public testing::Test {
  protected:
    void SetUp() override {
        for (const auto& path : {std::string("tileset.json"), tiles::tileset::subtree_path({})})
            index_.learn(path, city_.entries().at(path));
    }
    /// A draw of the first steps of a tile, its words in the store.
    TileDraw draw_of(const TileRecord& record, uint32_t mesh_steps, bool atlas) {
        const GridPoint origin = city_.manifest().tile_origin(record);
        TileDraw draw;
        draw.address = record.address;
        draw.origin = {to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)};
        draw.mesh = store_.create();
        draw.mesh_steps = mesh_steps;
        if (!atlas) return draw;
        draw.atlas = store_.create();
        EXPECT_TRUE(
            store_.append(draw.atlas, std::vector<uint32_t>(record.steps(Layer::kAtlas)[0].decoded_bytes / 4)).ok());
        return draw;
    }
    void note(const std::vector<TileDraw>& draws) {
        appeared_.clear();
        drawn_.note(draws, [&](TileAddress tile, bool appeared) {
            if (appeared) appeared_.push_back(tile);
        });
    }

    test::TinyCity city_;
    CityIndex index_;
    HostLayerStore store_{1 << 20, 1 << 10, false};
    DrawnPrefixes drawn_{index_, store_};
    std::vector<TileAddress> appeared_;
};

TEST_F(DrawnPrefixesTest, EachPrefixCountsOnceAtItsLongest) {
    const TileRecord& child = city_.subtree().tiles[2];
    TileDraw draw = draw_of(child, 1, false);
    note({draw});
    EXPECT_EQ(drawn_.bytes(), kStepBytes);
    EXPECT_EQ(appeared_, std::vector{child.address});
    note({draw});
    EXPECT_EQ(drawn_.bytes(), kStepBytes);
    EXPECT_TRUE(appeared_.empty());
    draw.mesh_steps = 2;
    note({draw});
    EXPECT_EQ(drawn_.bytes(), 2 * kStepBytes);
    note({draw_of(child, 1, true)});  // evicted and fetched again: the mesh was counted before
    EXPECT_EQ(drawn_.bytes(), 3 * kStepBytes);
    EXPECT_EQ(appeared_, std::vector{child.address});
}

TEST_F(DrawnPrefixesTest, TilesAtOneCornerAreToldApart) {
    // The root and its first child begin at the same point.
    const TileRecord &root = city_.subtree().tiles[0], &child = city_.subtree().tiles[1];
    ASSERT_EQ(city_.manifest().tile_origin(root), city_.manifest().tile_origin(child));
    EXPECT_EQ(index_.find(draw_of(root, 1, false))->address, root.address);
    EXPECT_EQ(index_.find(draw_of(child, 1, false))->address, child.address);
}

TEST_F(DrawnPrefixesTest, UnknownTilesAreLeftOut) {
    TileDraw draw = draw_of(city_.subtree().tiles[0], 1, false);
    draw.address = {20, 0, 0};
    note({draw});
    EXPECT_EQ(drawn_.bytes(), 0u);
    EXPECT_TRUE(appeared_.empty());
}

TEST(DrawnPrefixes, EachLevelOfAMapCountsOnceWhenItIsDrawn) {
    const test::SyntheticCity city;
    test::Flight flight(city);
    CityIndex index;
    index.learn("tileset.json", city.entries.at("tileset.json"));
    for (const auto& [path, bytes] : city.entries) {
        if (path.starts_with("subtrees/") || path == tiles::tileset::kFacadeIndexPath) index.learn(path, bytes);
    }
    FacadeDictionary dictionary;
    dictionary.learn(city.maps);
    DrawnPrefixes with_maps(index, flight.store), without_maps(index, flight.store);
    std::set<MapPiece> pieces;
    for (const double metres : {55.0, 30.0, 8.0, 30.0}) {
        std::vector<TileDraw> draws = flight.update(city.camera(30, -metres, 8, 0, 0));
        with_maps.note(draws, [](TileAddress, bool) {});
        for (TileDraw& draw : draws) {
            for (const FacadeMapBinding& binding : draw.facade_maps)
                pieces.insert(map_piece(binding.map, binding.level));
            draw.facade_maps.clear();
        }
        without_maps.note(draws, [](TileAddress, bool) {});
        uint64_t expected = 0;
        for (const MapPiece piece : pieces) expected += dictionary.wire_bytes(piece);
        EXPECT_EQ(with_maps.bytes() - without_maps.bytes(), expected);
    }
    EXPECT_GT(pieces.size(), 5u);
}

TEST(DrawnPrefixes, EachSharedChartCountsOnceAtItsLongest) {
    test::SyntheticOptions options;
    options.shared_charts = 7;
    const test::SyntheticCity city(options);
    test::Flight flight(city);
    CityIndex index;
    index.learn("tileset.json", city.entries.at("tileset.json"));
    for (const auto& [path, bytes] : city.entries) {
        if (path.starts_with("subtrees/") || path == tiles::tileset::kChartIndexPath) index.learn(path, bytes);
    }
    ChartDictionary dictionary;
    dictionary.learn(city.charts);
    DrawnPrefixes with_charts(index, flight.store), without_charts(index, flight.store);
    std::map<uint32_t, uint32_t> levels;
    for (const double metres : {90.0, 30.0, 8.0, 60.0}) {
        std::vector<TileDraw> draws = flight.update(city.camera(30, -metres, 8, 0, 0));
        with_charts.note(draws, [](TileAddress, bool) {});
        for (TileDraw& draw : draws) {
            for (const SharedChartBinding& binding : draw.shared_charts) {
                levels[binding.chart] = std::max(levels[binding.chart], binding.levels);
            }
            draw.shared_charts.clear();
        }
        without_charts.note(draws, [](TileAddress, bool) {});
        uint64_t expected = 0;
        for (const auto& [chart, most] : levels) expected += dictionary.wire_bytes(ChartPrefix{chart, most});
        EXPECT_EQ(with_charts.bytes() - without_charts.bytes(), expected);
    }
    EXPECT_GT(levels.size(), 3u);
}

TEST(AddressInPath, ReadsOnlyWholeAddresses) {
    EXPECT_EQ(address_in_path("tiles/3/1/2.mesh", "tiles"), (TileAddress{3, 1, 2}));
    EXPECT_EQ(address_in_path("subtrees/0/0/0.subtree", "subtrees"), (TileAddress{0, 0, 0}));
    for (const char* other : {"tiles/3/1.mesh", "tiles/3/1/2", "tiles/a/1/2.mesh", "tileset.json", "facades/maps",
                              "tiles", "tiles/3/1/99999999999.mesh"}) {
        EXPECT_FALSE(address_in_path(other, "tiles")) << other;
    }
}

}  // namespace
}  // namespace citystream::client
