// Flights of the real programs with and without relief: what each knob costs and draws, and that relief that is not
// there costs nothing.

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;

/// Along the street of the generated city, from outside to between the houses.
constexpr const char* kPath = "t,x,y,z,yaw,pitch,fov\n0,9,-60,6,0,4,65\n1,9,-20,6,0,4,65\n";

/// Statistics of a flight.
Json fly(const std::string& city, const std::vector<std::string>& more = {}) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", kPath);
    std::vector<std::string> command = {
        program("citystream-fly"), city, "--path", folder / "path.csv", "--fps", "1", "--size", "320x180", "--stats",
        folder / "stats.json"};
    command.insert(command.end(), more.begin(), more.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.exit_code == 0 ? Json::parse(read_file(folder / "stats.json"))["summary"] : Json();
}

TEST(ReliefFlight, ACityWithoutReliefMakesNoPipelineAndFetchesNoByteOfTheDictionary) {
    const TemporaryFolder folder;
    const Outcome built = run({program("citystream-build"), "generate", "--buildings", "40", "--seed", "7", "--layers",
                               "mesh,atlas", "-o", folder / "plain.3tz"});
    ASSERT_EQ(built.exit_code, 0) << built.error;
    const Json plain = fly(folder / "plain.3tz")["facades"];
    EXPECT_FALSE(plain["pipeline"]);
    EXPECT_EQ(plain["dictionary_bytes"], 0);
    EXPECT_EQ(plain["relief_tiles"], 0);
    const Json relief = fly(shared_city())["facades"];
    EXPECT_TRUE(relief["pipeline"]);
    EXPECT_GT(relief["dictionary_bytes"], 0);
    EXPECT_GT(relief["relief_tiles"], 0);
}

TEST(ReliefFlight, ReliefBelowItsToleranceCostsNothingEither) {
    const Json flat = fly(shared_city(), {"--relief-tolerance", "1000000"})["facades"];
    EXPECT_FALSE(flat["pipeline"]);
    EXPECT_EQ(flat["dictionary_bytes"], 0);
    EXPECT_EQ(flat["relief_tiles"], 0);
    EXPECT_GT(flat["flat_tiles"], 0);
}

TEST(ReliefFlight, CoarserLevelsCostFewerBytes) {
    const uint64_t coarse = fly(shared_city(), {"--map-level", "0"})["facades"]["map_bytes"];
    const uint64_t fine = fly(shared_city(), {"--map-level", "3"})["facades"]["map_bytes"];
    EXPECT_GT(coarse, 0u);
    EXPECT_LT(coarse, fine);
}

TEST(ReliefFlight, RenderersOfOtherFormsConvertTheSameMaps) {
    const Json patch = fly(shared_city()), binary = fly(shared_city(), {"--facade-renderer", "bcfdm"});
    EXPECT_EQ(patch["facades"]["conversions"], 0);
    EXPECT_GT(binary["facades"]["conversions"], 0);
    EXPECT_EQ(patch["facades"]["map_bytes"], binary["facades"]["map_bytes"]);
    EXPECT_EQ(patch["facades"]["maps_most"], binary["facades"]["maps_most"]);
    EXPECT_LT(patch["bytes"]["gpu_max"], binary["bytes"]["gpu_max"]);
}

TEST(ReliefFlight, WrongKnobsAreNamed) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", kPath);
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"--facade-renderer", "cones"}, {"--map-level", "4"}, {"--relief-tolerance", "0"}};
    for (const auto& [knob, value] : wrong) {
        const Outcome outcome =
            run({program("citystream-fly"), shared_city(), "--path", folder / "path.csv", knob, value});
        EXPECT_EQ(outcome.exit_code, 2) << knob;
        EXPECT_NE(outcome.error.find(knob), std::string::npos) << outcome.error;
    }
}

}  // namespace
}  // namespace citystream::tests
