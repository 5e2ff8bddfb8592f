// The radiance layer through the builder: which tiles get it, that it does not depend on threads or memory, what is
// taken from the archive that is replaced, and that neighbouring tiles agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "codec/radiance/radiance_layer.h"
#include "tests/tiles/layers/memory_count.h"
#include "tests/tiles/layers/radiance_builds.h"
#include "tiles/layers/inspect_city.h"

namespace citystream::tiles::layers {
namespace {

using codec::radiance::MatrixForm;
using codec::radiance::RadianceTile;
using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

constexpr auto kRadiance = static_cast<size_t>(Layer::kRadiance);

class RadianceBuild : public RadianceBuildTest {
  protected:
    RadianceBuild() : RadianceBuildTest(8, 8) {}

    BuildSummary built(const std::string& name, const CitySource& source,
                       const std::function<void(BuildOptions&)>& change = {}) const {
        auto summary = build(name, source, change);
        EXPECT_TRUE(summary) << summary.error().text();
        if (!summary || !summary->radiance) return {};
        EXPECT_EQ(summary->radiance->tiles, summary->radiance->baked + summary->radiance->reused);
        EXPECT_EQ(summary->radiance->left_out, 0U);
        return std::move(*summary);
    }
};

/// A box from corner to corner, metres, without floor.
struct Box {
    city::Vec3 low, high;
};

city::CityObject object_of(const Box& box, uint32_t material) {
    city::CityObject object;
    object.id = "box";
    object.kind = city::ObjectKind::kBuilding;
    for (const double z : {box.low.z, box.high.z}) {
        for (const auto& [x, y] : {std::pair{box.low.x, box.low.y},
                                   {box.high.x, box.low.y},
                                   {box.high.x, box.high.y},
                                   {box.low.x, box.high.y}})
            object.vertices.push_back({x, y, z});
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

CitySource boxes(std::vector<Box> list) {
    return [list = std::move(list)](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                                    const city::CitySink& sink) -> Status {
        const uint32_t material = catalog.add_material({});
        for (const Box& box : list) {
            ++report.buildings_emitted;
            if (!sink(object_of(box, material))) break;
        }
        return Done{};
    };
}

/// Towers in rows of ten, 14 m wide, 25 m apart.
std::vector<Box> town(double west, double south, uint32_t towers) {
    std::vector<Box> list;
    for (uint32_t i = 0; i < towers; ++i) {
        const double x = west + 25.0 * (i % 10), y = south + 25.0 * (i / 10), height = 8 + (i * 13) % 30;
        list.push_back({{x, y, 0}, {x + 14, y + 14, height}});
    }
    return list;
}

struct LayerBytes {
    std::vector<std::span<const std::byte>> steps;
    uint64_t decoded_bytes = 0;
};

LayerBytes radiance_of(const OpenCity& city, const TileRecord& record) {
    LayerBytes layer;
    const auto bytes = city.reader->find(tileset::layer_path(Layer::kRadiance, record.address));
    uint64_t begin = 0;
    for (const tileset::StepRecord& step : record.steps(Layer::kRadiance)) {
        layer.steps.push_back(bytes.subspan(begin, step.end - begin));
        layer.decoded_bytes += step.decoded_bytes;
        begin = step.end;
    }
    return layer;
}

RadianceTile radiance_tile_of(const OpenCity& city, const TileRecord& record) {
    const LayerBytes layer = radiance_of(city, record);
    auto tile = codec::radiance::decode_radiance_tile(layer.steps, layer.decoded_bytes);
    EXPECT_TRUE(tile) << tile.error().text();
    return tile ? std::move(*tile) : RadianceTile{};
}

TEST_F(RadianceBuild, EveryTileHasTheLayerAndEachPrefixOfItIsWhole) {
    const BuildSummary summary =
        built("city.3tz", generated(30), [](BuildOptions& options) { options.leaf_triangles = 800; });
    const OpenCity city = open_city(path("city.3tz"));
    EXPECT_TRUE(city.manifest.has_layer[kRadiance]);
    EXPECT_EQ(city.manifest.radiance_texels_across, 8U);
    EXPECT_EQ(city.manifest.radiance_local_across, 8U);
    EXPECT_EQ(city.manifest.radiance_lattice_metres, 8U);
    EXPECT_GT(city.tiles.size(), 1U);
    uint64_t receivers = 0;
    for (const auto& [address, record] : city.tiles) {
        const LayerBytes layer = radiance_of(city, record);
        ASSERT_EQ(layer.steps.size(), 3U);
        EXPECT_EQ(record.steps(Layer::kRadiance).back().error, 0);
        uint64_t bytes = 0;
        for (size_t count = 1; count <= layer.steps.size(); ++count) {
            bytes += record.steps(Layer::kRadiance)[count - 1].decoded_bytes;
            for (const MatrixForm form : {MatrixForm::kRows, MatrixForm::kBiclusters}) {
                const auto words =
                    codec::radiance::decode_radiance_layer(std::span(layer.steps).first(count), bytes, form);
                ASSERT_TRUE(words) << words.error().text();
                const auto view = codec::radiance::RadianceLayerView::create(*words);
                ASSERT_TRUE(view) << view.error().text();
                receivers += form == MatrixForm::kRows && count == 1 ? view->receivers() : 0;
                if (address.level == 0 || count < 3) break;  // biclusters are searched for
            }
        }
    }
    EXPECT_EQ(receivers, summary.radiance->receivers);
    EXPECT_EQ(summary.radiance->baked, city.tiles.size());
    EXPECT_GT(summary.radiance->rays, receivers * 600);
    const auto damages = verify_city(path("city.3tz"));
    ASSERT_TRUE(damages);
    EXPECT_TRUE(damages->empty()) << damages->front();
}

TEST_F(RadianceBuild, ALeafHasAtMost64ColumnsOfItsLatticeAcross) {
    const std::vector<Box> list = {{{10, 10, 0}, {30, 30, 12}}, {{2000, 900, 0}, {2020, 930, 20}}};
    for (const uint32_t lattice : {2U, 4U}) {
        built("city.3tz", boxes(list), [lattice](BuildOptions& options) {
            options.radiance.lattice_metres = lattice;
            options.auto_ground = false;
            options.radiance.texels_across = 2;
        });
        const OpenCity city = open_city(path("city.3tz"));
        size_t leaves = 0;
        for (const auto& [address, record] : city.tiles) {
            const RadianceTile tile = radiance_tile_of(city, record);
            const double side = city.manifest.side_metres(address.level),
                         spacing = to_metres(int64_t{1} << tile.spacing_log2);
            const bool leaf = !has_children(city, address);
            EXPECT_EQ(spacing, std::max((leaf ? 1.0 : 2.0) * lattice, side / 64)) << side;
            if (!leaf) continue;
            ++leaves;
            EXPECT_LE(side, 64 * lattice);
        }
        EXPECT_EQ(leaves, 2U);
    }
}

TEST_F(RadianceBuild, BytesDoNotDependOnThreadsOrMemory) {
    built("one.3tz", generated(20), [](BuildOptions& options) { options.jobs = 1; });
    built("three.3tz", generated(20), [](BuildOptions& options) { options.jobs = 3; });
    built("small.3tz", generated(20), [](BuildOptions& options) { options.memory_limit = 1 << 20; });
    EXPECT_EQ(bytes_of("one.3tz"), bytes_of("three.3tz"));
    EXPECT_EQ(bytes_of("one.3tz"), bytes_of("small.3tz"));
}

#ifdef CITYSTREAM_COUNTS_MEMORY
TEST_F(RadianceBuild, UnderALowLimitManyThreadsHoldNoMoreThanOne) {
    std::vector<Box> list;
    for (const double south : {0.0, 256.0, 512.0}) {
        for (const Box& box : town(0, south, 20)) list.push_back(box);
    }
    const auto peak_of = [&](uint32_t jobs) {
        memory_count::start();
        built("city.3tz", boxes(list), [jobs](BuildOptions& options) {
            options.jobs = jobs;
            options.memory_limit = 1 << 20;
            options.leaf_triangles = 250;
            options.radiance.reuse = false;
        });
        return memory_count::peak();
    };
    const uint64_t one = peak_of(1), four = peak_of(4);
    EXPECT_LT(static_cast<double>(four), 1.25 * static_cast<double>(one));
}
#endif

TEST_F(RadianceBuild, WithoutTheLayerNothingOfItIsThere) {
    const auto without = [](BuildOptions& options) { options.layers[kRadiance] = false; };
    ASSERT_TRUE(build("a.3tz", generated(20), without));
    ASSERT_TRUE(build("b.3tz", generated(20), [&](BuildOptions& options) {
        without(options);
        options.radiance = {.lattice_metres = 1, .texels_across = 64, .local_across = 12, .reuse = false};
    }));
    EXPECT_EQ(bytes_of("a.3tz"), bytes_of("b.3tz"));
    EXPECT_EQ(bytes_of("a.3tz").find("adiance"), std::string::npos);
    EXPECT_EQ(bytes_of("a.3tz").find("lattice"), std::string::npos);
}

TEST_F(RadianceBuild, AnUnchangedCityIsNotBakedAgain) {
    const BuildSummary first = built("city.3tz", generated(20));
    const std::string bytes = bytes_of("city.3tz");
    EXPECT_EQ(first.radiance->reused, 0U);
    const BuildSummary second = built("city.3tz", generated(20));
    EXPECT_EQ(second.radiance->baked, 0U);
    EXPECT_EQ(second.radiance->reused, first.radiance->baked);
    EXPECT_EQ(second.radiance->rays, 0U);
    EXPECT_EQ(bytes_of("city.3tz"), bytes);
    const BuildSummary third =
        built("city.3tz", generated(20), [](BuildOptions& options) { options.radiance.reuse = false; });
    EXPECT_EQ(third.radiance->baked, first.radiance->baked);
    EXPECT_EQ(bytes_of("city.3tz"), bytes);
    // Another lattice, source or set of local directions is another layer.
    const BuildSummary other =
        built("city.3tz", generated(20), [](BuildOptions& options) { options.radiance.local_across = 4; });
    EXPECT_EQ(other.radiance->reused, 0U);
}

TEST_F(RadianceBuild, AChangedBuildingBakesOnlyWhatIsWithinReachOfIt) {
    std::vector<Box> list = town(0, 0, 20), east = town(4000, 0, 20);
    list.insert(list.end(), east.begin(), east.end());
    const auto few = [](BuildOptions& options) {
        options.radiance.lattice_metres = 16;
        options.radiance.texels_across = 4;
    };
    const BuildSummary first = built("city.3tz", boxes(list), few);
    list[3].high.z += 9;
    const BuildSummary second = built("city.3tz", boxes(list), few);
    EXPECT_GT(second.radiance->baked, 0U);
    // The eastern town and the ground before it are further away than the horizon.
    EXPECT_GT(second.radiance->reused, first.radiance->tiles / 3);
    const std::string bytes = bytes_of("city.3tz");
    built("fresh.3tz", boxes(list), few);
    EXPECT_EQ(bytes, bytes_of("fresh.3tz"));
}

TEST_F(RadianceBuild, ACityThatMovedKeepsItsLayers) {
    std::vector<Box> list = town(0, 0, 12);
    const BuildSummary first = built("city.3tz", boxes(list));
    for (Box& box : list) {
        box.low.x += 128 * 1024;
        box.high.x += 128 * 1024;
    }
    const BuildSummary second = built("city.3tz", boxes(list));
    EXPECT_EQ(second.radiance->reused, first.radiance->tiles);
}

/// The archive that is replaced, with one byte changed at a place that `where` finds.
void damage(const std::string& file, const std::function<uint64_t(const archive::ArchiveReader&)>& where) {
    const auto reader = archive::ArchiveReader::open(file);
    ASSERT_TRUE(reader);
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(where(**reader)));
    const int byte = stream.get();
    stream.seekp(static_cast<std::streamoff>(where(**reader)));
    stream.put(static_cast<char>(byte ^ 0x10));
}

uint64_t begin_of(const archive::ArchiveReader& reader, const std::string& ending) {
    for (const archive::ArchiveEntry& entry : reader.entries()) {
        if (entry.name.ends_with(ending)) return entry.data_offset;
    }
    ADD_FAILURE() << "no entry " << ending;
    return 0;
}

TEST_F(RadianceBuild, ADamagedLayerOfTheReplacedArchiveIsBakedAgainAndSaid) {
    const CitySource source = boxes(town(0, 0, 12));
    const BuildSummary first = built("city.3tz", source);
    const std::string bytes = bytes_of("city.3tz");
    damage(path("city.3tz"), [](const auto& reader) { return begin_of(reader, ".radiance") + 20; });
    const BuildSummary second = built("city.3tz", source);
    EXPECT_EQ(second.radiance->baked, 1U);
    EXPECT_EQ(second.radiance->reused, first.radiance->baked - 1);
    ASSERT_EQ(second.report.defects.size(), 1U);
    EXPECT_NE(second.report.defects[0].what.find("1 radiance layers"), std::string::npos);
    EXPECT_EQ(bytes_of("city.3tz"), bytes);
}

TEST_F(RadianceBuild, AFileThatIsNoCityIsReplacedAndSaid) {
    const CitySource source = boxes(town(0, 0, 6));
    built("city.3tz", source);
    const std::string bytes = bytes_of("city.3tz");
    for (const std::string& content : {std::string("not an archive"), std::string(), bytes.substr(0, 3000)}) {
        std::ofstream(path("city.3tz"), std::ios::binary) << content;
        const BuildSummary summary = built("city.3tz", source);
        EXPECT_EQ(summary.radiance->reused, 0U);
        ASSERT_EQ(summary.report.defects.size(), 1U);
        EXPECT_NE(summary.report.defects[0].what.find("no whole archive"), std::string::npos);
        EXPECT_EQ(bytes_of("city.3tz"), bytes);
    }
    damage(path("city.3tz"), [](const auto& reader) { return begin_of(reader, ".subtree") + 40; });
    EXPECT_EQ(built("city.3tz", source).report.defects.size(), 1U);
    EXPECT_EQ(bytes_of("city.3tz"), bytes);
}

TEST_F(RadianceBuild, AnInterruptedBakeLeavesNothingBehind) {
    std::atomic<bool> cancel = false;
    bool reached = false;
    const auto summary = build("city.3tz", generated(20), [&](BuildOptions& options) {
        options.cancel = &cancel;
        options.progress = [&](std::string_view stage, uint64_t done, uint64_t) {
            if (stage != "radiance" || done == 0) return;
            reached = true;
            cancel = true;
        };
    });
    EXPECT_TRUE(reached);
    ASSERT_FALSE(summary);
    EXPECT_EQ(summary.error().text(), "interrupted");
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(RadianceBuild, WrongFormsAreRefused) {
    for (const RadianceForm& wrong :
         {RadianceForm{.lattice_metres = 3}, RadianceForm{.lattice_metres = 0}, RadianceForm{.lattice_metres = 32},
          RadianceForm{.texels_across = 0}, RadianceForm{.texels_across = 65}, RadianceForm{.local_across = 0},
          RadianceForm{.local_across = 33}}) {
        const auto summary = build("city.3tz", generated(1), [&](BuildOptions& options) { options.radiance = wrong; });
        ASSERT_FALSE(summary);
        EXPECT_NE(summary.error().text().find("possible"), summary.error().text().find("it is 1, 2, 4, 8 or 16 m"));
    }
}

/// Receivers of two leaves that are the same place of the same surface.
struct Seam {
    size_t shared = 0, same_sight = 0;
};

/// In units that tiles have in common: columns and depths counted from the world's origin.
codec::radiance::ReceiverPlace moved(codec::radiance::ReceiverPlace place, const GridPoint& origin, int64_t spacing) {
    const std::array<int64_t, 3> by = {origin.x, origin.y, origin.z};
    const uint32_t own = place.surface_class / 2;
    for (size_t k = 0; k < 2; ++k) place.column[k] += static_cast<int32_t>(by[(own + 1 + k) % 3] / spacing);
    place.depth += static_cast<int32_t>(by[own]);
    return place;
}

Seam compare(const OpenCity& a, const OpenCity& b, TileAddress left, TileAddress right) {
    const auto receivers_of = [](const OpenCity& city, TileAddress address) {
        const TileRecord& record = city.tiles.at(address);
        RadianceTile tile = radiance_tile_of(city, record);
        const int64_t side = int64_t{1} << (city.manifest.root_side_log2 + kGridBits - address.level);
        const GridPoint origin = {address.x * side, address.y * side, record.base_height};
        for (auto& place : tile.places) place = moved(place, origin, int64_t{1} << tile.spacing_log2);
        return tile;
    };
    const RadianceTile one = receivers_of(a, left), other = receivers_of(b, right);
    Seam seam;
    for (uint32_t i = 0; i < one.places.size(); ++i) {
        for (uint32_t j = 0; j < other.places.size(); ++j) {
            if (!(one.places[i] == other.places[j])) continue;
            ++seam.shared;
            const auto sight = one.visibility.of(i), there = other.visibility.of(j);
            seam.same_sight += std::equal(sight.begin(), sight.end(), there.begin(), there.end()) ? 1 : 0;
        }
    }
    return seam;
}

TEST_F(RadianceBuild, NeighbouringLeavesAgreeAboutReceiversTheyShareAndWouldNotWithoutTheirHalo) {
    // Ground and towers on both sides of the border between the leaves, at x = 128 m.
    std::vector<Box> west, east;
    for (uint32_t i = 0; i < 10; ++i) {
        const double x = 25.0 * (i % 2), y = 10 + 25.0 * (i / 2);
        west.push_back({{65 + x, y, 0}, {79 + x, y + 14, 20 + x / 5}});
        east.push_back({{140 + x, y, 0}, {154 + x, y + 14, 60 + x / 5}});
    }
    const auto with = [&west](const std::vector<Box>& more) {
        std::vector<Box> all = west;
        all.insert(all.end(), more.begin(), more.end());
        return boxes(all);
    };
    const auto options = [](BuildOptions& change) {
        change.leaf_triangles = 150;
        change.radiance.lattice_metres = 4;
        change.radiance.texels_across = 4;
    };
    built("both.3tz", with(east), options);
    for (Box& box : east) box.high.z = 0.1;
    built("flat.3tz", with(east), options);
    const OpenCity city = open_city(path("both.3tz"));
    const TileAddress left = {1, 0, 0}, right = {1, 1, 0};
    ASSERT_EQ(city.tiles.count(left) + city.tiles.count(right), 2U);
    ASSERT_FALSE(has_children(city, left) || has_children(city, right));
    const Seam seam = compare(city, city, left, right);
    EXPECT_GE(seam.shared, 25U);
    EXPECT_EQ(seam.same_sight, seam.shared);
    const Seam without = compare(open_city(path("flat.3tz")), city, left, right);
    EXPECT_GE(without.shared, 25U);
    EXPECT_LT(without.same_sight, without.shared / 2) << "light comes in where the neighbour's towers should be";
}

}  // namespace
}  // namespace citystream::tiles::layers
