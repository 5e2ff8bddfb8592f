// The facade dictionary: which maps travel, in which order, and in which levels.
#include "tiles/layers/facade_dictionary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "codec/facade/facade_form.h"
#include "codec/facade/facade_wire.h"
#include "codec/facade/grid_difference.h"
#include "tests/tiles/archive/temporary_folder.h"
#include "tiles/city/grammar_facades.h"
#include "tiles/quadtree/tile_tree.h"
#include "tiles/tileset/facade_index.h"

namespace citystream::tiles::layers {
namespace {

using archive::TemporaryFolder;
using codec::facade::make_label;
using codec::facade::RunGrid;

/// A wall of 4 m x 3 m with a window; depths and the frame's material vary.
RunGrid wall_map(int32_t window_mm, int32_t frame_mm, uint32_t frame_slot = 2) {
    const uint32_t wall = make_label(0, 0), frame = make_label(frame_mm, frame_slot), glass = make_label(window_mm, 3);
    return {{0, 130, 140, 260, 270, 400}, {0, 90, 100, 240, 300}, {wall,  wall,  wall, wall, wall,  wall,  frame,
                                                                   frame, frame, wall, wall, frame, glass, frame,
                                                                   wall,  wall,  wall, wall, wall,  wall}};
}

class Dictionary : public testing::Test {
  protected:
    void SetUp() override {
        objects_ = quadtree::ObjectSpool::create(folder_ / ".").value();
        catalog_.palettes.emplace_back();
        catalog_.palettes[0].material.fill(catalog_.add_material({}));
    }

    /// A wall of this map that stands at (x, y) metres.
    void add_wall(double x, double y, uint32_t map) {
        city::CityObject object;
        object.kind = city::ObjectKind::kBuilding;
        city::FacadeWall wall;
        wall.lower_left = {x, y, 0};
        wall.along = {4, 0};
        wall.height = 3;
        wall.map = map;
        object.facades = {wall};
        city::CityReport report;
        ASSERT_TRUE(objects_->add(object, catalog_, report).ok());
        ASSERT_EQ(report.defect_count, 0U);
    }

    FacadeNumbers numbers(uint32_t tolerance_mm = 0) {
        EXPECT_TRUE(quadtree::make_tile_tree(*objects_, {}).ok());
        auto result = number_facades(*objects_, catalog_.facade_maps, tolerance_mm);
        EXPECT_TRUE(result.ok());
        return std::move(result).value();
    }

    struct Encoded {
        EncodedFacades facades;
        std::vector<std::byte> entry;
    };
    Encoded encode(const FacadeNumbers& of, uint32_t jobs) {
        BuildOptions options;
        options.jobs = jobs;
        const std::string name = "run" + std::to_string(runs_++);
        const auto spool = quadtree::SpoolFile::create(folder_ / (name + ".spool")).value();
        auto facades = EncodedFacades::encode(of, catalog_.facade_maps, options, *spool);
        EXPECT_TRUE(facades.ok()) << (facades.ok() ? "" : facades.error().text());
        const auto writer = archive::ArchiveWriter::create(folder_ / (name + ".3tz")).value();
        const std::byte one{1};
        EXPECT_TRUE(writer->add("first", std::span(&one, 1)).ok());
        EXPECT_TRUE(facades->write_entry(*writer, *spool).ok());
        EXPECT_TRUE(writer->finish().ok());
        const auto reader = archive::ArchiveReader::open(folder_ / (name + ".3tz")).value();
        const auto entry = reader->find(tileset::kFacadeMapsPath);
        return {std::move(facades).value(), {entry.begin(), entry.end()}};
    }

    TemporaryFolder folder_;
    std::unique_ptr<quadtree::ObjectSpool> objects_;
    city::CityCatalog catalog_;
    int runs_ = 0;
};

TEST_F(Dictionary, NumbersMapsByFirstUseAlongTheMortonCurveAndLeavesOutTheUnused) {
    std::vector<uint32_t> map;
    for (int i = 0; i < 6; ++i) map.push_back(catalog_.facade_maps.add(wall_map(-50 - i, -20)));
    add_wall(1000, 1000, map[0]);
    add_wall(10, 1000, map[1]);
    add_wall(1000, 10, map[2]);
    add_wall(10, 10, map[4]);
    add_wall(12, 10, map[0]);
    const FacadeNumbers found = numbers();
    EXPECT_EQ(found.maps, (std::vector<uint32_t>{map[4], map[0], map[2], map[1]}));
    EXPECT_EQ(found.number[map[4]], 0U);
    EXPECT_EQ(found.number[map[1]], 3U);
    EXPECT_EQ(found.shown[map[2]], map[2]);
    for (const uint32_t unused : {map[3], map[5]}) {
        EXPECT_EQ(found.shown[unused], FacadeNumbers::kUnused);
        EXPECT_EQ(found.number[unused], FacadeNumbers::kUnused);
    }
    EXPECT_EQ(found.merged, 0U);
}

TEST_F(Dictionary, WithinTheToleranceTheFirstMapOfOneLikenessStandsForTheOthers) {
    const uint32_t first = catalog_.facade_maps.add(wall_map(-100, -40));
    const uint32_t near = catalog_.facade_maps.add(wall_map(-103, -42));
    const uint32_t chained = catalog_.facade_maps.add(wall_map(-106, -40));  // near `near`, not near `first`
    const uint32_t other_material = catalog_.facade_maps.add(wall_map(-100, -40, 5));
    RunGrid open = wall_map(-100, -40);
    open.labels.back() = make_label(codec::facade::kOpenDisplacement, 0);
    const uint32_t with_opening = catalog_.facade_maps.add(open);
    double x = 0;
    for (const uint32_t map : {first, near, chained, other_material, with_opening, near}) add_wall(x += 5, 0, map);
    const FacadeNumbers exact = numbers(0);
    EXPECT_EQ(exact.maps.size(), 5U);
    const FacadeNumbers merged = numbers(3);
    EXPECT_EQ(merged.maps, (std::vector<uint32_t>{first, chained, other_material, with_opening}));
    EXPECT_EQ(merged.shown[near], first);
    EXPECT_EQ(merged.merged, 1U);
    EXPECT_EQ(merged.greatest_difference_mm, 3);
    EXPECT_EQ(merged.number[first], 0U);
    EXPECT_EQ(merged.number[chained], 1U);
    EXPECT_EQ(numbers(6).shown[chained], first);
    EXPECT_EQ(numbers(2).maps.size(), 5U);
}

TEST_F(Dictionary, MergedMapsAreNowhereFurtherApartThanTheTolerance) {
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
        const auto mm = [&] { return -static_cast<int32_t>(random() % 40); };
        const int32_t window = mm();
        add_wall(5 * i, 0, catalog_.facade_maps.add(wall_map(window, mm())));
    }
    for (const uint32_t tolerance : {1U, 4U, 12U}) {
        const FacadeNumbers found = numbers(tolerance);
        EXPECT_GT(found.merged, 10U);
        int32_t greatest = 0;
        for (uint32_t map = 0; map < catalog_.facade_maps.size(); ++map) {
            const RunGrid own = catalog_.facade_maps.map(map), shown = catalog_.facade_maps.map(found.shown[map]);
            const auto apart = codec::facade::difference(own, shown);
            EXPECT_FALSE(apart.materials || apart.openings);
            greatest = std::max(greatest, apart.displacement_mm);
        }
        EXPECT_LE(greatest, static_cast<int32_t>(tolerance));
        EXPECT_EQ(greatest, found.greatest_difference_mm);
        // What stays is pairwise further apart.
        for (size_t i = 1; i < std::min<size_t>(found.maps.size(), 30); ++i) {
            EXPECT_GT(codec::facade::difference(catalog_.facade_maps.map(found.maps[i]),
                                                catalog_.facade_maps.map(found.maps[i - 1]))
                          .displacement_mm,
                      static_cast<int32_t>(tolerance));
        }
    }
}

TEST_F(Dictionary, EveryLevelExpandsToTheCoarsenedMapItsRecordDescribes) {
    for (const auto use : {city::procedural::FacadeUse::kHouse, city::procedural::FacadeUse::kApartment,
                           city::procedural::FacadeUse::kHall}) {
        city::procedural::FacadeSpec spec;
        spec.use = use;
        spec.floors = 2;
        spec.width_cm = 1200;
        add_wall(5 * static_cast<double>(use), 0, catalog_.facade_maps.add(derive_facade(spec, 1)));
    }
    const FacadeNumbers of = numbers();
    const Encoded encoded = encode(of, 2);
    ASSERT_EQ(encoded.facades.records().size(), 3U);
    ASSERT_TRUE(tileset::check_facade_maps(encoded.facades.records()).ok());
    uint64_t begin = 0;
    size_t levels = 0;
    for (size_t i = 0; i < 3; ++i) {
        const tileset::FacadeMapRecord& record = encoded.facades.records()[i];
        const RunGrid exact = catalog_.facade_maps.map(of.maps[i]);
        EXPECT_EQ(record.width, exact.width());
        EXPECT_EQ(record.height, exact.height());
        EXPECT_EQ(record.depth_min_mm, exact.depths().min_mm);
        EXPECT_EQ(record.depth_max_mm, exact.depths().max_mm);
        uint64_t finer = UINT64_MAX;
        for (uint32_t k = record.level_count; k-- > 0;) {
            const tileset::FacadeLevelRecord& level = record.level[k];
            const uint64_t from = k > 0 ? record.level[k - 1].end : begin;
            const auto payload = std::span(encoded.entry).subspan(from, level.end - from);
            EXPECT_EQ(level.checksum, static_cast<uint32_t>(tileset::checksum_of(payload.data(), payload.size())));
            const auto words = codec::facade::expand_wire(payload, level.resident_bytes);
            ASSERT_TRUE(words.ok()) << words.error().text();
            const auto grid = codec::facade::decode_form(*words);
            ASSERT_TRUE(grid.ok());
            EXPECT_EQ(*grid, level.texel_cm == 1 ? exact : codec::facade::coarsen(exact, level.texel_cm));
            EXPECT_LE(static_cast<double>(payload.size()), kMostLevelShare * static_cast<double>(finer));
            finer = payload.size();
            ++levels;
        }
        begin = record.levels().back().end;
    }
    EXPECT_EQ(begin, encoded.entry.size());
    EXPECT_GE(levels, 4U) << "no map of three has a coarser level";
}

TEST_F(Dictionary, IsTheSameForAnyNumberOfThreads) {
    std::mt19937 random(9);
    for (int i = 0; i < 60; ++i) {
        city::procedural::FacadeSpec spec;
        spec.use = static_cast<city::procedural::FacadeUse>(random() % 3);
        spec.variant = static_cast<uint8_t>(random() % 9);
        spec.floors = static_cast<uint8_t>(1 + random() % 3);
        spec.width_cm = static_cast<uint16_t>(500 + 25 * (random() % 20));
        add_wall(static_cast<double>(random() % 2000), static_cast<double>(random() % 2000),
                 catalog_.facade_maps.add(derive_facade(spec, 1)));
    }
    const FacadeNumbers of = numbers();
    const Encoded one = encode(of, 1), three = encode(of, 3);
    EXPECT_EQ(one.entry, three.entry);
    EXPECT_EQ(one.facades.records(), three.facades.records());
}

TEST_F(Dictionary, WithoutMapsThereIsNoEntry) {
    const Encoded none = encode(FacadeNumbers(), 2);
    EXPECT_TRUE(none.facades.records().empty());
    EXPECT_TRUE(none.entry.empty());
}

TEST_F(Dictionary, StopsWhenTheBuildIsInterrupted) {
    add_wall(0, 0, catalog_.facade_maps.add(wall_map(-50, -20)));
    const FacadeNumbers of = numbers();
    const std::atomic<bool> cancel = true;
    BuildOptions options;
    options.cancel = &cancel;
    const auto spool = quadtree::SpoolFile::create(folder_ / "interrupted").value();
    EXPECT_FALSE(EncodedFacades::encode(of, catalog_.facade_maps, options, *spool).ok());
}

}  // namespace
}  // namespace citystream::tiles::layers
