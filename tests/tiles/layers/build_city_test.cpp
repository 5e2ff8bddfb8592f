// The builder end to end: small cities in, archives out, read back through the public readers.
#include "tiles/layers/build_city.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/step_choice.h"
#include "tests/tiles/layers/city_builds.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {
namespace {

using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

class BuildCity : public CityBuildTest {};

/// A box of ten triangles (no floor) from corner to corner.
city::CityObject box(const city::Vec3& lo, const city::Vec3& hi, uint32_t material) {
    city::CityObject object;
    object.id = "box";
    object.kind = city::ObjectKind::kBuilding;
    for (double z : {lo.z, hi.z}) {
        for (const auto& p : {city::Vec3{lo.x, lo.y, z}, city::Vec3{hi.x, lo.y, z}, city::Vec3{hi.x, hi.y, z},
                              city::Vec3{lo.x, hi.y, z}})
            object.vertices.push_back(p);
    }
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        city::Triangle triangle;
        triangle.vertex = {a, b, c};
        triangle.material = material;
        object.triangles.push_back(triangle);
    };
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t j = (i + 1) % 4;
        add(i, j, j + 4);
        add(i, j + 4, i + 4);
    }
    add(4, 5, 6);
    add(4, 6, 7);
    return object;
}

CitySource boxes(const std::vector<std::array<city::Vec3, 2>>& corners) {
    return [corners](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                     const city::CitySink& sink) -> Status {
        const uint32_t material = catalog.add_material({});
        for (const auto& [lo, hi] : corners) {
            ++report.buildings_emitted;
            if (!sink(box(lo, hi, material))) break;
        }
        return Done{};
    };
}

TEST_F(BuildCity, RefusesACityWithoutObjects) {
    const auto summary = build("empty.3tz", boxes({}));
    ASSERT_FALSE(summary.ok());
    EXPECT_NE(summary.error().text().find("nothing to build"), std::string::npos);
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(BuildCity, OneBuildingIsOneTileThatVerifies) {
    const auto summary = build("one.3tz", boxes({{{{10, 10, 5}, {20, 18, 12}}}}));
    ASSERT_TRUE(summary.ok());
    EXPECT_EQ(summary->manifest.tiles, 1U);
    EXPECT_EQ(summary->manifest.buildings, 1U);
    const auto damages = verify_city(path("one.3tz"));
    ASSERT_TRUE(damages.ok());
    EXPECT_TRUE(damages->empty());
    const auto info = read_city_info(path("one.3tz"));
    ASSERT_TRUE(info.ok());
    EXPECT_EQ((*info)["extent"], nlohmann::json({10.0, 10.0, 5.0, 20.0, 18.0, 12.0}));
}

TEST_F(BuildCity, ABuildingOnFourTilesIsWholeInExactlyOneLeaf) {
    std::vector<std::array<city::Vec3, 2>> corners = {{{{120, 120, 0}, {140, 140, 30}}}};
    for (double x : {10.0, 200.0}) {
        for (double y : {10.0, 200.0}) corners.push_back({{{x, y, 0}, {x + 5, y + 5, 5}}});
    }
    const auto summary = build("four.3tz", boxes(corners), [](BuildOptions& options) {
        options.leaf_triangles = 8;
        options.auto_ground = false;
    });
    ASSERT_TRUE(summary.ok());
    const OpenCity city = open_city(path("four.3tz"));
    int holders = 0;
    for (const auto& [address, tile] : city.tiles) {
        if (has_children(city, address)) continue;
        const auto mesh = mesh_of(city, tile);
        const bool tall = std::any_of(
            mesh.vertices.begin(), mesh.vertices.end(),
            [&](const codec::mesh::MeshVertex& v) { return v.position[2] + tile.base_height == to_grid(30); });
        if (!tall) continue;
        ++holders;
        EXPECT_EQ(mesh.triangle_chart.size(), 10U);
    }
    EXPECT_EQ(holders, 1);
}

TEST_F(BuildCity, KeepsAKilometreHighTowerInEveryLevel) {
    std::vector<std::array<city::Vec3, 2>> corners = {{{{500, 500, 0}, {530, 530, 1000}}}};
    for (int i = 0; i < 60; ++i)
        corners.push_back({{{i * 17.0, (i * 37) % 1000 * 1.0, 0}, {i * 17.0 + 8, (i * 37) % 1000 + 8.0, 6}}});
    const auto summary = build("tower.3tz", boxes(corners), [](BuildOptions& options) { options.leaf_triangles = 60; });
    ASSERT_TRUE(summary.ok());
    const OpenCity city = open_city(path("tower.3tz"));
    std::set<uint32_t> levels;
    for (const auto& [address, tile] : city.tiles) {
        if (tile.bounds.max[2] < 999) continue;
        for (const auto& v : mesh_of(city, tile).vertices) {
            if (v.position[2] + tile.base_height >= to_grid(999)) levels.insert(address.level);
        }
    }
    ASSERT_FALSE(levels.empty());
    EXPECT_EQ(*levels.begin(), 0U);
    EXPECT_EQ(levels.size(), static_cast<size_t>(*levels.rbegin()) + 1);
}

TEST_F(BuildCity, WritesTheSameBytesWithOneAndWithThreeThreads) {
    ASSERT_TRUE(build("a.3tz", generated(60), [](BuildOptions& options) { options.jobs = 1; }).ok());
    ASSERT_TRUE(build("b.3tz", generated(60), [](BuildOptions& options) { options.jobs = 3; }).ok());
    EXPECT_EQ(bytes_of("a.3tz"), bytes_of("b.3tz"));
}

TEST_F(BuildCity, ACityMovedByTenMillionMetresHasTheSameTiles) {
    const auto small_leaves = [](BuildOptions& options) { options.leaf_triangles = 1500; };
    ASSERT_TRUE(build("here.3tz", generated(40), small_leaves).ok());
    ASSERT_TRUE(build("there.3tz", generated(40, {1e7, 1e7}), small_leaves).ok());
    const auto here = archive::ArchiveReader::open(path("here.3tz")),
               there = archive::ArchiveReader::open(path("there.3tz"));
    ASSERT_TRUE(here.ok() && there.ok());
    size_t compared = 0;
    for (const archive::ArchiveEntry& entry : (*here)->entries()) {
        if (!entry.name.starts_with("tiles/")) continue;
        const auto a = (*here)->find(entry.name), b = (*there)->find(entry.name);
        EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << entry.name;
        ++compared;
    }
    EXPECT_GT(compared, 3U);
}

TEST_F(BuildCity, ErrorsAndBoundsGrowUpTheTree) {
    ASSERT_TRUE(build("city.3tz", generated(150), [](BuildOptions& options) { options.leaf_triangles = 1500; }).ok());
    const OpenCity city = open_city(path("city.3tz"));
    size_t inner = 0;
    for (const auto& [address, tile] : city.tiles) {
        if (!has_children(city, address)) {
            EXPECT_EQ(tile.geometric_error, 0);
        } else {
            ++inner;
        }
        if (address.level == 0) continue;
        const TileRecord& parent = city.tiles.at(address.parent());
        EXPECT_GE(parent.geometric_error, tile.geometric_error);
        for (size_t axis = 0; axis < 3; ++axis) {
            EXPECT_LE(parent.bounds.min[axis], tile.bounds.min[axis]);
            EXPECT_GE(parent.bounds.max[axis], tile.bounds.max[axis]);
        }
    }
    EXPECT_GT(inner, 1U);
    EXPECT_EQ(city.tiles.size(), city.manifest.tiles);
}

TEST_F(BuildCity, InnerTilesStateAnErrorOfAtLeastTheTexelsOfTheirPictures) {
    for (const auto& [shared, law] : {std::pair{false, "0.02"}, {false, "0.02,4,8"}, {true, "0.02,4,8"}}) {
        const auto built = build("city.3tz", generated(150), [&](BuildOptions& options) {
            options.leaf_triangles = 1500;
            options.shared_charts = shared;
            options.texture_law = *parse_texture_law(law);
            options.rate_distortion = 0;  // faster
        });
        ASSERT_TRUE(built.ok());
        const OpenCity city = open_city(path("city.3tz"));
        size_t inner = 0;
        for (const auto& [address, tile] : city.tiles) {
            if (!has_children(city, address) || tile.steps(Layer::kAtlas).empty()) continue;
            ++inner;
            const float stand_ins = tile.flat_facade_error;  // pictures of relief are shown only while it allows
            EXPECT_GE(std::max(tile.geometric_error, stand_ins), tile.steps(Layer::kAtlas).back().error);
            if (shared) continue;  // whose pictures are as fine as those of leaves
            // Their pictures have texels of half the geometry's error, or of a level law above leaves of 2 cm.
            if (law != std::string_view("0.02")) {
                EXPECT_GE(tile.geometric_error, 0.08F);
                continue;
            }
            EXPECT_GE(tile.geometric_error, std::ldexp(1.0F, static_cast<int>(city.manifest.root_side_log2) -
                                                                 static_cast<int>(address.level) - 10));
        }
        EXPECT_GT(inner, 1U);
    }
}

TEST_F(BuildCity, EverythingDrawnLiesInTheRootSquareAndTheCitysHeights) {
    for (const auto& source : {generated(60), boxes({{{{0, 0, 3}, {128, 128, 9}}}})}) {
        ASSERT_TRUE(build("city.3tz", source).ok());
        const OpenCity city = open_city(path("city.3tz"));
        const double side = std::ldexp(1.0, static_cast<int>(city.manifest.root_side_log2));
        const tileset::Bounds& root = city.tiles.at({}).bounds;
        for (size_t axis = 0; axis < 2; ++axis) {
            EXPECT_GE(root.min[axis], 0);
            EXPECT_LE(root.max[axis], side);
        }
        EXPECT_GE(root.min[2], city.manifest.extent.min[2]);
        EXPECT_LE(root.max[2], city.manifest.extent.max[2]);
    }
}

TEST_F(BuildCity, NeighbouringLeavesShareTheirGroundBorderPoints) {
    ASSERT_TRUE(build("city.3tz", generated(150), [](BuildOptions& options) { options.leaf_triangles = 1500; }).ok());
    const OpenCity city = open_city(path("city.3tz"));
    // Points at which up-facing ground meets the line between a tile and its eastern neighbour of the same level.
    const auto border = [&](const TileRecord& tile, int64_t x) {
        std::set<std::array<int64_t, 2>> points;
        const GridPoint origin = city.manifest.tile_origin(tile);
        const auto mesh = mesh_of(city, tile);
        std::map<std::array<int64_t, 2>, int64_t> top;  // skirts hang below their own upper points
        for (const auto& v : mesh.vertices) {
            if (origin.x + v.position[0] != x || v.normal[2] < 0.9F) continue;
            const auto [found, is_new] = top.try_emplace({origin.y + v.position[1], 0}, origin.z + v.position[2]);
            if (!is_new) found->second = std::max(found->second, origin.z + v.position[2]);
        }
        for (const auto& [at, z] : top) points.insert({at[0], z});
        return points;
    };
    size_t compared = 0;
    for (const auto& [address, tile] : city.tiles) {
        const auto east = city.tiles.find({address.level, address.x + 1, address.y});
        if (east == city.tiles.end() || has_children(city, address) || has_children(city, east->first)) continue;
        const int64_t x = city.manifest.tile_origin(east->second).x;
        EXPECT_EQ(border(tile, x), border(east->second, x));
        compared += border(tile, x).size();
    }
    EXPECT_GT(compared, 4U);
}

TEST_F(BuildCity, VerifyNamesTheTileAndLayerOfAFlippedByte) {
    ASSERT_TRUE(build("city.3tz", generated(20)).ok());
    const OpenCity city = open_city(path("city.3tz"));
    const std::string whole = bytes_of("city.3tz");
    for (const char* suffix : {".mesh", ".facade", ".atlas", "facades/maps", "facades/index"}) {
        const auto& entries = city.reader->entries();
        const auto entry = std::find_if(entries.begin(), entries.end(),
                                        [&](const archive::ArchiveEntry& e) { return e.name.ends_with(suffix); });
        ASSERT_NE(entry, entries.end());
        std::string damaged = whole;
        damaged[entry->data_offset + entry->size / 2] =
            static_cast<char>(damaged[entry->data_offset + entry->size / 2] ^ 4);
        std::ofstream(path("damaged.3tz"), std::ios::binary) << damaged;
        const auto damages = verify_city(path("damaged.3tz"));
        ASSERT_TRUE(damages.ok());
        EXPECT_TRUE(std::any_of(damages->begin(), damages->end(), [&](const std::string& line) {
            return line.find(entry->name) != std::string::npos;
        })) << suffix;
    }
}

TEST_F(BuildCity, VerifyNamesTheMapAndLevelOfADamagedDictionary) {
    ASSERT_TRUE(build("city.3tz", generated(20)).ok());
    const OpenCity city = open_city(path("city.3tz"));
    const auto maps = tileset::parse_facade_index(city.reader->find(tileset::kFacadeIndexPath), city.manifest);
    ASSERT_TRUE(maps.ok());
    ASSERT_GT(maps->size(), 5U);
    const auto& entries = city.reader->entries();
    const auto entry = std::find_if(entries.begin(), entries.end(),
                                    [](const archive::ArchiveEntry& e) { return e.name == tileset::kFacadeMapsPath; });
    ASSERT_NE(entry, entries.end());
    const std::string whole = bytes_of("city.3tz");
    for (const size_t map : {size_t{0}, size_t{3}, maps->size() - 1}) {
        std::string damaged = whole;
        char& byte = damaged[entry->data_offset + (*maps)[map].levels().back().end - 1];
        byte = static_cast<char>(byte ^ 0x10);
        std::ofstream(path("damaged.3tz"), std::ios::binary) << damaged;
        const auto damages = verify_city(path("damaged.3tz"));
        ASSERT_TRUE(damages.ok());
        const std::string name = "facades/maps: map " + std::to_string(map) + ": level " +
                                 std::to_string((*maps)[map].level_count - 1) + ":";
        EXPECT_EQ(std::count_if(damages->begin(), damages->end(),
                                [&](const std::string& line) { return line.starts_with("facades/maps: map"); }),
                  1);
        EXPECT_TRUE(std::any_of(damages->begin(), damages->end(), [&](const std::string& line) {
            return line.starts_with(name);
        })) << name;
    }
}

TEST_F(BuildCity, InfoAddsUpTheLevelsAndFormsOfTheDictionary) {
    ASSERT_TRUE(build("city.3tz", generated(10)).ok());
    const auto info = read_city_info(path("city.3tz"));
    ASSERT_TRUE(info.ok());
    const nlohmann::json& facades = (*info)["facade_dictionary"];
    const OpenCity city = open_city(path("city.3tz"));
    EXPECT_EQ(facades["maps"], city.manifest.facade_map_count);
    EXPECT_EQ(facades["wire_bytes"], city.reader->find(tileset::kFacadeMapsPath).size());
    EXPECT_EQ(facades["index_bytes"], city.reader->find(tileset::kFacadeIndexPath).size());
    EXPECT_EQ(facades["levels"]["1 cm"]["maps"], city.manifest.facade_map_count);
    EXPECT_FALSE(facades["made_up"]);
    for (const char* parts : {"levels", "forms"}) {
        uint64_t wire = 0, resident = 0;
        for (const nlohmann::json& part : facades[parts]) {
            wire += part["wire_bytes"].get<uint64_t>();
            resident += part["resident_bytes"].get<uint64_t>();
        }
        EXPECT_EQ(facades["wire_bytes"], wire) << parts;
        EXPECT_EQ(facades["resident_bytes"], resident) << parts;
    }
}

TEST_F(BuildCity, ACityWithoutTheFacadeLayerCarriesNoMaps) {
    ASSERT_TRUE(build("city.3tz", generated(10), [](BuildOptions& options) {
                    options.layers = {true, false, true, false};
                }).ok());
    const OpenCity city = open_city(path("city.3tz"));
    EXPECT_EQ(city.manifest.greatest_subtree_bytes, city.greatest_subtree_bytes);
    EXPECT_EQ(city.manifest.facade_map_count, 0U);
    EXPECT_EQ(city.reader->find(tileset::kFacadeMapsPath).data(), nullptr);
    EXPECT_TRUE(verify_city(path("city.3tz"))->empty());
}

TEST_F(BuildCity, ACityWithoutPicturesIsGreyAndHasPrisms) {
    ASSERT_TRUE(build("city.3tz", generated(50), [](BuildOptions& options) {
                    options.layers = {true, false, false, false};
                }).ok());
    const OpenCity city = open_city(path("city.3tz"));
    uint64_t triangles = 0, in_prisms = 0;
    for (const auto& [address, record] : city.tiles) {
        const codec::mesh::MeshContent content = mesh_layer_of(city, record).content;
        in_prisms += codec::mesh::triangle_count(content) - content.triangles.size();
        codec::mesh::for_each_triangle(content, [&](const codec::mesh::PlacedTriangle& triangle) {
            ++triangles;
            EXPECT_EQ(triangle.chart_word, CHART_WORD_UNTEXTURED);
        });
    }
    EXPECT_GT(triangles, 0U);
    EXPECT_GT(in_prisms, 0U);
    EXPECT_TRUE(verify_city(path("city.3tz"))->empty());
}

TEST_F(BuildCity, TilesHaveAsManyStepsAsPayOrAsManyAsTheyAreTold) {
    const auto bytes_with = [&](std::optional<uint32_t> steps) {
        EXPECT_TRUE(build("city.3tz", generated(50), [&](BuildOptions& options) { options.mesh.steps = steps; }).ok());
        const OpenCity city = open_city(path("city.3tz"));
        EXPECT_EQ(steps.has_value(), city.manifest.build_options.find("mesh-steps") != std::string::npos);
        uint64_t bytes = 0;
        for (const auto& [address, record] : city.tiles) {
            const auto& mesh = record.steps(Layer::kMesh);
            if (mesh.empty()) continue;
            EXPECT_LE(mesh.size(), steps.value_or(kMostChosenSteps));
            bytes += mesh.front().end + codec::mesh::kWholeToFirst * mesh.back().end;
        }
        return bytes;
    };
    const uint64_t chosen = bytes_with({});
    for (const uint32_t steps : {1U, 2U, 3U}) EXPECT_LE(chosen, bytes_with(steps)) << steps;
}

/// Walls with a window each, 3 mm deeper from wall to wall.
CitySource windows(uint32_t walls) {
    return [walls](city::CityHeader&, city::CityCatalog& catalog, city::CityReport&,
                   const city::CitySink& sink) -> Status {
        catalog.palettes.emplace_back();
        catalog.palettes[0].material.fill(catalog.add_material({}));
        for (uint32_t i = 0; i < walls; ++i) {
            codec::facade::RunGrid grid{{0, 100, 250, 400}, {0, 90, 220, 300}, std::vector<uint32_t>(9)};
            grid.labels[4] = codec::facade::make_label(-100 - 3 * static_cast<int32_t>(i), 3);
            city::CityObject object;
            object.kind = city::ObjectKind::kBuilding;
            object.facades.push_back({{5.0 * i, 0, 0}, {4, 0}, 3, catalog.facade_maps.add(grid), 0});
            if (!sink(std::move(object))) break;
        }
        return Done{};
    };
}

TEST_F(BuildCity, TheToleranceOfMergedMapsIsWrittenDown) {
    const auto merge = [](BuildOptions& options) { options.merge_tolerance_mm = 4; };
    ASSERT_TRUE(build("exact.3tz", windows(10)).ok());
    ASSERT_TRUE(build("merged.3tz", windows(10), merge).ok());
    const tileset::Manifest exact = open_city(path("exact.3tz")).manifest,
                            merged = open_city(path("merged.3tz")).manifest;
    EXPECT_EQ(exact.facade_map_count, 10U);
    EXPECT_EQ(merged.facade_map_count, 5U);
    EXPECT_EQ(merged.facades, 10U);
    EXPECT_NE(merged.build_options.find("merge-tolerance=4mm (5 maps merged, 3 mm apart at most)"), std::string::npos)
        << merged.build_options;
    EXPECT_EQ(exact.build_options.find("merge-tolerance"), std::string::npos);
    EXPECT_TRUE(verify_city(path("merged.3tz"))->empty());
}

TEST_F(BuildCity, FacadesOnAPlainCityAreMarkedAsMadeUp) {
    const CitySource plain = boxes({{{{0, 0, 0}, {20, 12, 9}}}, {{{40, 0, 0}, {60, 15, 6}}}});
    ASSERT_TRUE(build("plain.3tz", plain).ok());
    ASSERT_TRUE(build("dressed.3tz", plain, [](BuildOptions& options) { options.dress_seed = 7; }).ok());
    const tileset::Manifest bare = open_city(path("plain.3tz")).manifest,
                            dressed = open_city(path("dressed.3tz")).manifest;
    EXPECT_FALSE(bare.facades_made_up);
    EXPECT_EQ(bare.facades, 0U);
    EXPECT_TRUE(dressed.facades_made_up);
    EXPECT_GE(dressed.facades, 8U);
    EXPECT_TRUE(read_city_info(path("dressed.3tz")).value()["facades_made_up"]);
    EXPECT_TRUE(verify_city(path("dressed.3tz"))->empty());
}

TEST_F(BuildCity, ADressedCityIsTheSameForAnyNumberOfThreads) {
    std::vector<std::array<city::Vec3, 2>> corners;
    for (int i = 0; i < 40; ++i) {
        const double x = 37.0 * (i % 8), y = 41.0 * static_cast<double>(i / 8), height = 6 + i % 5 * 4;
        corners.push_back({{{x, y, 0}, {x + 11 + i % 7, y + 13 + i % 3, height}}});
    }
    for (const uint32_t jobs : {1U, 3U}) {
        ASSERT_TRUE(build("jobs" + std::to_string(jobs) + ".3tz", boxes(corners), [&](BuildOptions& options) {
                        options.jobs = jobs;
                        options.dress_seed = 3;
                    }).ok());
    }
    EXPECT_EQ(bytes_of("jobs1.3tz"), bytes_of("jobs3.3tz"));
}

TEST_F(BuildCity, AnInterruptedBuildLeavesNothingBehind) {
    const std::atomic<bool> cancel = true;
    const auto summary = build("city.3tz", generated(20), [&](BuildOptions& options) { options.cancel = &cancel; });
    ASSERT_FALSE(summary.ok());
    EXPECT_EQ(summary.error().text(), "interrupted");
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(BuildCity, ReportsAnObjectWithoutNumbersAndBuildsTheRest) {
    city::CityReport report;
    BuildOptions options;
    options.output = path("nan.3tz");
    const auto summary =
        build_city(options, boxes({{{{0, 0, 0}, {5, 5, 5}}}, {{{0, 0, 0}, {5, 5, std::nan("")}}}}), report);
    ASSERT_TRUE(summary.ok());
    ASSERT_EQ(summary->report.dropped_features.size(), 1U);
    EXPECT_EQ(summary->report.dropped_features[0], "box");
}

TEST_F(BuildCity, MakesUpGroundOnlyWhereThereIsNone) {
    ASSERT_TRUE(build("bare.3tz", boxes({{{{0, 0, 3}, {5, 5, 9}}}})).ok());
    EXPECT_NE(open_city(path("bare.3tz")).manifest.build_options.find("made-up"), std::string::npos);
    ASSERT_TRUE(build("ground.3tz", generated(5)).ok());
    EXPECT_EQ(open_city(path("ground.3tz")).manifest.build_options.find("made-up"), std::string::npos);
}

TEST_F(BuildCity, TheReferenceShowsTheMadeUpGroundToo) {
    const auto triangles_with = [&](bool ground) {
        const auto summary = build("city.3tz", boxes({{{{0, 0, 3}, {5, 5, 9}}}}), [&](BuildOptions& options) {
            options.reference = path("city.glb");
            options.auto_ground = ground;
        });
        EXPECT_TRUE(summary.ok());
        const std::string bytes = bytes_of("city.glb");
        uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, sizeof(length));
        const auto json = nlohmann::json::parse(bytes.substr(20, length));
        uint64_t indices = 0;
        for (const auto& mesh : json["meshes"]) {
            for (const auto& primitive : mesh["primitives"])
                indices += json["accessors"][primitive["indices"].get<size_t>()]["count"].get<uint64_t>();
        }
        return indices / 3;
    };
    EXPECT_EQ(triangles_with(false), 10U);
    EXPECT_EQ(triangles_with(true), 12U);
}

TEST_F(BuildCity, TheReferenceIsABinaryGltfOfItsStatedLength) {
    const auto summary =
        build("city.3tz", generated(5), [&](BuildOptions& options) { options.reference = path("city.glb"); });
    ASSERT_TRUE(summary.ok());
    const std::string bytes = bytes_of("city.glb");
    ASSERT_GT(bytes.size(), 20U);
    std::array<uint32_t, 5> head{};
    std::memcpy(head.data(), bytes.data(), sizeof(head));
    EXPECT_EQ(head[0], 0x46546c67U);
    EXPECT_EQ(head[2], bytes.size());
    const auto json = nlohmann::json::parse(bytes.substr(20, head[3]));
    EXPECT_EQ(json["asset"]["extras"]["citystream"]["origin"].size(), 3U);
    for (const auto& view : json["bufferViews"]) {
        EXPECT_LE(view["byteOffset"].get<uint64_t>() + view["byteLength"].get<uint64_t>(),
                  json["buffers"][0]["byteLength"].get<uint64_t>());
    }
}

TEST_F(BuildCity, SharedChartsMakeTheAtlasSmallerAndDoNotDependOnThreads) {
    const auto make = [&](const std::string& name, bool shared, uint32_t jobs) {
        auto summary = build(name, generated(30), [&](BuildOptions& options) {
            options.leaf_triangles = 500;
            options.shared_charts = shared;
            options.jobs = jobs;
        });
        EXPECT_TRUE(summary.ok());
        return std::move(summary).value();
    };
    const auto own = make("own.3tz", false, 2), shared = make("shared.3tz", true, 2);
    make("again.3tz", true, 1);
    EXPECT_EQ(bytes_of("shared.3tz"), bytes_of("again.3tz"));
    const auto atlas_bytes = [](const BuildSummary& of) {
        const tileset::Manifest& m = of.manifest;
        return m.wire_bytes[static_cast<size_t>(Layer::kAtlas)] + m.chart_index_bytes + m.chart_levels_bytes;
    };
    EXPECT_GT(shared.manifest.tiles, 4U);
    EXPECT_EQ(own.manifest.shared_chart_count, 0U);
    EXPECT_GT(shared.manifest.shared_chart_count, 3U);
    EXPECT_LT(2 * atlas_bytes(shared), atlas_bytes(own));
    const auto damages = verify_city(path("shared.3tz"));
    ASSERT_TRUE(damages.ok());
    EXPECT_EQ(*damages, std::vector<std::string>());
    const auto info = read_city_info(path("shared.3tz"));
    ASSERT_TRUE(info.ok());
    EXPECT_EQ((*info)["chart_dictionary"]["charts"], shared.manifest.shared_chart_count);
    EXPECT_EQ((*info)["chart_dictionary"]["wire_bytes"], shared.manifest.chart_levels_bytes);
    EXPECT_FALSE(read_city_info(path("own.3tz"))->contains("chart_dictionary"));
    EXPECT_EQ(open_city(path("own.3tz")).reader->find(tileset::kChartIndexPath).data(), nullptr);
}

TEST_F(BuildCity, DamageOfASharedChartIsNamed) {
    ASSERT_TRUE(build("city.3tz", generated(40), [](BuildOptions& options) {
                    options.leaf_triangles = 500;
                    options.shared_charts = true;
                }).ok());
    std::string bytes = bytes_of("city.3tz");
    {
        const auto reader = archive::ArchiveReader::open(path("city.3tz")).value();
        const auto entries = reader->entries();
        const auto levels = std::find_if(entries.begin(), entries.end(),
                                         [](const auto& entry) { return entry.name == tileset::kChartLevelsPath; });
        ASSERT_NE(levels, entries.end());
        bytes[levels->data_offset + levels->size / 2] ^= 1;
    }
    std::ofstream(path("city.3tz"), std::ios::binary) << bytes;
    const auto damages = verify_city(path("city.3tz"));
    ASSERT_TRUE(damages.ok());
    ASSERT_EQ(damages->size(), 2U) << "the entry's CRC and the chart";
    EXPECT_NE((*damages)[1].find("charts/levels: chart "), std::string::npos) << (*damages)[1];
    EXPECT_NE((*damages)[1].find("checksum"), std::string::npos) << (*damages)[1];
}

}  // namespace
}  // namespace citystream::tiles::layers
