#include "client/stream/flight_statistics.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using Json = nlohmann::json;

Json flown(const test::SyntheticCity& city, double height, bool pipeline) {
    test::Flight flight(city);
    FlightStatistics statistics({});
    for (uint64_t i = 0; i < 5; ++i) {
        flight.update(city.camera(100 + 20.0 * static_cast<double>(i), 60, height, 30, -20));
        FlightFrame frame;
        frame.index = i;
        frame.stream = flight.frame;
        statistics.add(std::move(frame));
    }
    FlightTotals totals;
    totals.fetcher = flight.fetcher.statistics();
    totals.facade_pipeline = pipeline;
    return Json::parse(statistics.json(totals));
}

TEST(FlightStatistics, ReliefAndTheDictionaryAreCountedByFrameAndInAll) {
    const test::SyntheticCity city;
    const Json json = flown(city, 12, true);
    const Json& all = json["summary"]["facades"];
    EXPECT_TRUE(all["pipeline"]);
    EXPECT_EQ(all["index_bytes"], city.entries.at(tiles::tileset::kFacadeIndexPath).size());
    EXPECT_EQ(all["dictionary_bytes"], all["index_bytes"].get<uint64_t>() + all["map_bytes"].get<uint64_t>());
    EXPECT_GT(all["map_bytes"], 0);
    uint64_t map_bytes = 0, relief = 0;
    for (const Json& frame : json["frames"]) {
        map_bytes += frame["facades"]["map_bytes"].get<uint64_t>();
        relief += frame["facades"]["relief_tiles"].get<uint64_t>();
        EXPECT_EQ(frame["facades"]["maps"].size(), codec::facade::kMostFacadeLevels);
    }
    EXPECT_EQ(all["map_bytes"], map_bytes);
    EXPECT_EQ(all["relief_tiles"], relief);
    EXPECT_GT(relief, 0u);
    EXPECT_GT(all["maps_most"][0], 0);
}

TEST(FlightStatistics, TheChartDictionaryIsCountedByFrameAndInAll) {
    test::SyntheticOptions options;
    options.shared_charts = 20;
    const test::SyntheticCity city(options);
    const Json json = flown(city, 12, true);
    const Json& all = json["summary"]["charts"];
    EXPECT_EQ(all["index_bytes"], city.entries.at(tiles::tileset::kChartIndexPath).size());
    uint64_t level_bytes = 0, most = 0;
    for (const Json& frame : json["frames"]) {
        level_bytes += frame["charts"]["level_bytes"].get<uint64_t>();
        most = std::max(most, frame["charts"]["shared"].get<uint64_t>());
    }
    EXPECT_GT(level_bytes, 0u);
    EXPECT_EQ(all["level_bytes"], level_bytes);
    EXPECT_EQ(all["dictionary_bytes"], level_bytes + all["index_bytes"].get<uint64_t>());
    EXPECT_EQ(all["shared_most"], most);
    EXPECT_GT(most, 3u);
    EXPECT_EQ(flown(test::SyntheticCity(), 3, false)["summary"]["charts"]["dictionary_bytes"], 0);
}

TEST(FlightStatistics, BytesOfLayersAndDictionariesAndSubtreesAreAllThatWasReceived) {
    test::SyntheticOptions options;
    options.shared_charts = 20;
    const Json json = flown(test::SyntheticCity(options), 12, true);
    const Json& all = json["summary"]["bytes"];
    uint64_t of_layers = 0, atlas = 0;
    for (const Json& bytes : all["layers"]) of_layers += bytes.get<uint64_t>();
    for (const Json& frame : json["frames"]) atlas += frame["bytes"]["layers"]["atlas"].get<uint64_t>();
    EXPECT_EQ(all["layers"]["atlas"], atlas);
    EXPECT_GT(atlas, 0u);
    EXPECT_GT(all["layers"]["mesh"], 0);
    const uint64_t of_dictionaries = json["summary"]["facades"]["dictionary_bytes"].get<uint64_t>() +
                                     json["summary"]["charts"]["dictionary_bytes"].get<uint64_t>();
    EXPECT_LE(of_layers + of_dictionaries, all["wire"].get<uint64_t>());
    EXPECT_GT(of_layers + of_dictionaries, all["wire"].get<uint64_t>() / 2) << "the rest are subtrees";
}

TEST(FlightStatistics, LightIsCountedByFrameAndInAllAndWithoutItIsNothing) {
    test::SyntheticOptions with_light;
    with_light.light = 4;
    const test::SyntheticCity city(with_light);
    for (const bool lit : {false, true}) {
        StreamerOptions options;
        if (lit) options.light_tolerance = 0.05;
        test::Flight flight(city, options);
        FlightDescription description;
        if (lit) description.environment = "sky";
        FlightStatistics statistics(description);
        for (uint64_t i = 0; i < 3; ++i) {
            flight.update(city.camera(100 + 20.0 * static_cast<double>(i), 60, 12, 30, -20));
            FlightFrame frame;
            frame.stream = flight.frame;
            if (lit) {
                frame.lighting = {"sky", 1, 0, 9.5, 0.25, 1};
                frame.stream.caster_tiles = i == 0 ? 7 : 2;
                frame.counts.radiance_tiles = i == 0 ? 5 : 0;
                frame.counts.radiance_receivers = i == 0 ? 80 : 0;
            }
            statistics.add(std::move(frame));
        }
        FlightTotals totals;
        totals.radiance_pipeline = lit;
        const Json json = Json::parse(statistics.json(totals));
        const Json &all = json["summary"]["light"], &first = json["frames"][0]["light"];
        EXPECT_EQ(all["pipeline"], lit);
        EXPECT_EQ(json["summary"]["bytes"]["layers"]["radiance"].get<uint64_t>() > 0, lit);
        EXPECT_EQ(all["decodes"].get<uint64_t>() > 0, lit);
        EXPECT_EQ(all["layers_most"].get<uint64_t>() > 0, lit);
        EXPECT_EQ(all["casters_most"], lit ? 7 : 0);
        EXPECT_EQ(first["casters"], lit ? 7 : 0);
        EXPECT_EQ(all["pass_frames"], lit ? 1 : 0);
        EXPECT_EQ(all["pass_tiles"], lit ? 5 : 0);
        EXPECT_EQ(all["pass_receivers"], lit ? 80 : 0);
        EXPECT_EQ(all["tolerance_used_max"], lit ? 0.05 : 0.0);
        EXPECT_EQ(first["environment"], lit ? "sky" : "");
        EXPECT_EQ(first["hour"], lit ? 9.5 : 0.0);
        EXPECT_EQ(first["exposure"], lit ? 0.25 : 0.0);
        EXPECT_EQ(first["tiles"], lit ? json["frames"][0]["tiles"]["drawn"] : Json(0));
        EXPECT_EQ(json["flight"]["environment"], lit ? "sky" : "");
    }
}

TEST(FlightStatistics, WithoutReliefTheDictionaryCostsNothing) {
    test::SyntheticOptions plain;
    plain.facades = false;
    const Json json = flown(test::SyntheticCity(plain), 12, false);
    const Json& all = json["summary"]["facades"];
    EXPECT_FALSE(all["pipeline"]);
    EXPECT_EQ(all["dictionary_bytes"], 0);
    EXPECT_EQ(all["relief_tiles"], 0);
    EXPECT_EQ(all["flat_tiles"], 0);
    EXPECT_EQ(all["maps_most"], Json({0, 0, 0, 0}));
}

}  // namespace
}  // namespace citystream::client
