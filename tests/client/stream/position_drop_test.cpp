#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "client/cache/directory_cache.h"
#include "client/select/selection.h"
#include "client/stream/flight_statistics.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using Json = nlohmann::json;
using test::Flight;
using test::Layer;
using test::SyntheticCity;

const SyntheticCity& shared_city() {
    static const SyntheticCity city;
    return city;
}

/// From the street to high above.
std::vector<Camera> cameras() {
    std::vector<Camera> out;
    for (double z = 4; z < 3000; z *= 1.8) out.push_back(shared_city().camera(300 + z / 10, 350, z, 30, -75));
    return out;
}

StreamerOptions with_positions(double pixels, bool wait = true) {
    StreamerOptions options = test::whole_view();
    options.relief.tolerance_pixels = 1e6;
    options.position_tolerance_pixels = pixels;
    options.wait_for_selection = wait;
    return options;
}

/// What tiles drop, by the place that they begin at.
using Dropped = std::map<std::array<double, 3>, uint32_t>;

Dropped dropped_of(const std::vector<TileDraw>& draws) {
    Dropped out;
    for (const TileDraw& draw : draws) out[draw.origin] = draw.mesh_least_dropped;
    return out;
}

/// The same of a choice by the rule, with nothing resident.
class Choice {
  public:
    explicit Choice(double pixels)
        : directory_(shared_city().manifest, nullptr), selector_(directory_, knowledge_, {}, {}, pixels) {
        const SyntheticCity& city = shared_city();
        for (uint32_t level = 0; level < city.manifest.levels; level += city.manifest.subtree_levels) {
            for (const auto& [address, record] : city.tiles) {
                if (address.level != level) continue;
                EXPECT_TRUE(directory_.add_subtree(city.entries.at(subtree_path(address)), address));
            }
        }
        knowledge_.tiles.resize(directory_.nodes().size());
    }
    Dropped dropped(const Camera& camera) {
        Dropped out;
        for (const SelectedTile& tile : selector_.select(camera, 1, 4096).tiles) {
            const auto& record = *directory_.node(tile.node).record;
            const GridPoint origin = directory_.manifest().tile_origin(record);
            out[{to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)}] =
                dropped_bits(record.steps(Layer::kMesh))[tile.steps_of(Layer::kMesh) - 1u];
        }
        return out;
    }

  private:
    DirectoryCache directory_;
    CityKnowledge knowledge_;
    Selector selector_;
};

/// Realtime updates until nothing more arrives.
const std::vector<TileDraw>& settle(Flight& flight, const Camera& camera) {
    const std::vector<TileDraw>* draws = &flight.update(camera);
    int quiet = 0;
    for (int i = 0; i < 5000 && quiet < 3; ++i) {
        draws = &flight.update(camera);
        const bool busy = flight.frame.requests > 0 || flight.frame.wire_bytes > 0 || flight.frame.tiles_missing > 0;
        quiet = busy ? 0 : quiet + 1;
    }
    EXPECT_EQ(quiet, 3) << "something never comes";
    return *draws;
}

TEST(PositionDrop, ATileDropsWhatItsChosenStepDropsWhateverFinerIsHere) {
    for (const double pixels : {0.5, 4.0}) {
        Choice choice(pixels);
        Flight waiting(shared_city(), with_positions(pixels)), running(shared_city(), with_positions(pixels, false));
        std::set<uint32_t> seen;
        uint32_t finer_here = 0;
        for (const Camera& camera : cameras()) {
            const Dropped expected = choice.dropped(camera);
            const std::vector<TileDraw>& offline = waiting.update(camera);
            EXPECT_EQ(dropped_of(offline), expected);
            const std::vector<TileDraw>& realtime = settle(running, camera);
            EXPECT_EQ(dropped_of(realtime), expected);
            const auto rule = position_rule(camera, pixels).drop;
            for (const TileDraw& draw : realtime) {
                EXPECT_EQ(draw.drop_rule.distance_per_unit, rule.distance_per_unit);
                EXPECT_EQ(draw.drop_rule.common_dropped, rule.common_dropped);
                seen.insert(draw.mesh_least_dropped);
            }
            ASSERT_EQ(offline.size(), realtime.size());
            for (size_t i = 0; i < offline.size(); ++i) {
                finer_here += realtime[i].mesh_steps > offline[i].mesh_steps ? 1 : 0;
            }
        }
        EXPECT_GT(seen.size(), 3u);
        EXPECT_GT(finer_here, 0u) << "no tile has a finer step than it shows: the test is too easy";
    }
}

TEST(PositionDrop, ThePositionToleranceChangesBytesAndBitsOfPositionsAndNothingElse) {
    const SyntheticCity& city = shared_city();
    uint64_t bytes_before = ~uint64_t{0};
    double bits_before = 64;
    for (const double pixels : {0.125, 1.0, 8.0}) {
        Flight flight(city, with_positions(pixels)), plain(city, with_positions(1));
        uint64_t bytes = 0;
        double bits = 0;
        for (const Camera& camera : cameras()) {
            flight.update(camera);
            plain.update(camera);
            const StreamerFrame& frame = flight.frame;
            EXPECT_EQ(frame.tiles_drawn, plain.frame.tiles_drawn);
            EXPECT_EQ(frame.geometry_error_pixels, plain.frame.geometry_error_pixels);
            EXPECT_EQ(frame.full_position_bits, plain.frame.full_position_bits);
            EXPECT_LE(frame.position_bits, frame.full_position_bits);
            EXPECT_LE(frame.achieved_error_pixels, frame.geometry_error_pixels + frame.position_error_pixels);
            EXPECT_GE(frame.achieved_error_pixels, std::max(frame.geometry_error_pixels, frame.position_error_pixels));
            bytes += frame.layer_bytes[static_cast<size_t>(Layer::kMesh)];
            bits += frame.position_bits / static_cast<double>(cameras().size());
        }
        EXPECT_LT(bytes, bytes_before);
        EXPECT_LT(bits, bits_before);
        bytes_before = bytes;
        bits_before = bits;
    }
}

TEST(PositionDrop, VerticesAreNoFartherOffThanTheToleranceWhereTheGeometryIsThatGood) {
    Flight flight(shared_city(), with_positions(1));
    for (const Camera& camera : cameras()) {
        flight.update(camera);
        // A leaf near the camera drops what lies far below its own error, at most an eighth of it.
        const double allowed = std::max(1.0, flight.frame.geometry_error_pixels);
        EXPECT_LE(flight.frame.position_error_pixels, allowed) << camera.position[2];
        EXPECT_GT(flight.frame.position_error_pixels, 0);
    }
}

TEST(PositionDrop, StatisticsTellTheErrorsApartAndTogether) {
    Flight flight(shared_city(), with_positions(2));
    FlightDescription description;
    description.position_tolerance_pixels = 2;
    FlightStatistics statistics(description);
    for (const Camera& camera : cameras()) {
        flight.update(camera);
        FlightFrame frame;
        frame.stream = flight.frame;
        statistics.add(std::move(frame));
    }
    const Json json = Json::parse(statistics.json({}));
    EXPECT_EQ(json["flight"]["position_tolerance_pixels"], 2);
    double greatest = 0;
    for (size_t i = 0; i < statistics.frames().size(); ++i) {
        const Json& frame = json["frames"][i];
        const StreamerFrame& streamed = statistics.frames()[i].stream;
        EXPECT_EQ(frame["geometry_error_pixels"], streamed.geometry_error_pixels);
        EXPECT_EQ(frame["positions"]["error_pixels"], streamed.position_error_pixels);
        EXPECT_NEAR(frame["positions"]["bits"].get<double>(), streamed.position_bits, 1e-3);
        EXPECT_NEAR(frame["positions"]["full_bits"].get<double>(), streamed.full_position_bits, 1e-3);
        EXPECT_GT(streamed.position_bits, 4);
        greatest = std::max(greatest, streamed.position_error_pixels);
    }
    EXPECT_NEAR(json["summary"]["positions"]["error_pixels"]["max"].get<double>(), greatest, 1e-3);
    EXPECT_GT(json["summary"]["positions"]["full_bits"]["median"], json["summary"]["positions"]["bits"]["median"]);
}

}  // namespace
}  // namespace citystream::client
