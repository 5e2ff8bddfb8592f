// What `info` says of receivers and their bytes.
#include <gtest/gtest.h>

#include <fstream>

#include "codec/radiance/radiance_layer.h"
#include "tests/tiles/layers/radiance_builds.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/tileset/radiance_totals.h"

namespace citystream::tiles::layers {
namespace {

using tileset::Layer;

class InspectRadiance : public RadianceBuildTest {
  protected:
    InspectRadiance() : RadianceBuildTest(4, 4) {}
};

TEST_F(InspectRadiance, InfoCountsTheReceiversThatTheBuilderMade) {
    const auto summary = build("city.3tz", generated(30));
    ASSERT_TRUE(summary) << summary.error().text();
    const auto info = read_city_info(path("city.3tz"));
    ASSERT_TRUE(info) << info.error().text();
    const auto& radiance = (*info)["radiance"];
    const uint64_t receivers = radiance["receivers"], bytes = (*info)["layers"]["radiance"]["wire_bytes"];
    const uint64_t mesh_bytes = (*info)["layers"]["mesh"]["wire_bytes"];
    EXPECT_EQ(receivers, summary->radiance->receivers);
    EXPECT_EQ(radiance["tiles"], summary->radiance->tiles);
    const auto part = [](uint64_t some, uint64_t of) { return static_cast<double>(some) / static_cast<double>(of); };
    EXPECT_DOUBLE_EQ(radiance["bytes_a_receiver"], part(bytes, receivers));
    EXPECT_DOUBLE_EQ(radiance["percent_of_tile_bytes"], 100 * part(bytes, bytes + mesh_bytes));
    uint64_t of_levels = 0, finest = 0;
    for (const auto& level : radiance["levels"]) of_levels += finest = level["receivers"];
    EXPECT_EQ(of_levels, receivers);
    EXPECT_GT(radiance["levels"].size(), 1U) << "the test is too easy";
    EXPECT_EQ(radiance["leaf_receivers"], finest) << "all leaves are on the last level of this city";
    const auto& prefixes = radiance["prefixes"];
    EXPECT_EQ(prefixes.back()["wire_bytes"], bytes);
    EXPECT_LT(prefixes.back()["error"], prefixes[1]["error"]);
    EXPECT_LT(prefixes[0]["wire_bytes"], prefixes[1]["wire_bytes"]);
    EXPECT_GT(prefixes[0]["error"], prefixes[1]["error"]);
}

TEST_F(InspectRadiance, ACityWithoutTheLayerHasNothingOfIt) {
    ASSERT_TRUE(build("dark.3tz", generated(4), [](BuildOptions& options) { options.layers[3] = false; }));
    const auto info = read_city_info(path("dark.3tz"));
    ASSERT_TRUE(info);
    EXPECT_FALSE(info->contains("radiance"));
}

TEST_F(InspectRadiance, ADamagedLayerIsNamed) {
    ASSERT_TRUE(build("city.3tz", generated(4)));
    std::string bytes = bytes_of("city.3tz");
    const auto reader = archive::ArchiveReader::open(path("city.3tz"));
    ASSERT_TRUE(reader);
    const std::string name = tileset::layer_path(Layer::kRadiance, {});
    const auto& entries = (*reader)->entries();
    const auto entry = std::find_if(entries.begin(), entries.end(), [&](const auto& one) { return one.name == name; });
    ASSERT_NE(entry, entries.end());
    bytes[entry->data_offset + 8] = 99;  // log2 of the spacing
    std::ofstream(path("damaged.3tz"), std::ios::binary) << bytes;
    const auto info = read_city_info(path("damaged.3tz"));
    ASSERT_FALSE(info);
    EXPECT_NE(info.error().text().find(name), std::string::npos) << info.error().text();
}

}  // namespace
}  // namespace citystream::tiles::layers
