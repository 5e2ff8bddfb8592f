// What flights with the transports of charts' coordinates say of themselves (that their frames are the same:
// pages_flight_test.cpp).
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

TEST(ChartTransportFlight, StatisticsCountDrawsMemoryAndTilesThatFellBack) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", "t,x,y,z,yaw,pitch,fov\n0,-60,-40,60,40,-20,60\n");
    const Outcome built = run({program("citystream-build"), "generate", "--buildings", "40", "--seed", "7",
                               "--atlas-form", "pages", "-o", folder / "city.3tz"});
    ASSERT_EQ(built.exit_code, 0) << built.error;
    const auto fly = [&](const std::string& transport) {
        const Outcome flown =
            run({program("citystream-fly"), folder / "city.3tz", "--path", folder / "path.csv", "--fps", "1", "--size",
                 "320x180", "--stats", folder / "stats.json", "--chart-transport", transport, "--validation"});
        EXPECT_EQ(flown.exit_code, 0) << flown.error;
        const auto all = nlohmann::json::parse(read_file(folder / "stats.json"));
        EXPECT_EQ(all["flight"]["chart_transport"], transport);
        EXPECT_EQ(all["frames"][0]["pages"]["tiles"], all["summary"]["pages"]["tiles_most"]);
        return all["summary"]["pages"];
    };
    const auto table = fly("table"), uniform = fly("uniform"), attribute = fly("attribute"), packed = fly("packed");
    EXPECT_GT(table["tiles_most"], 0);
    for (const auto& pages : {table, uniform}) EXPECT_EQ(pages["coordinate_bytes_most"], 0);
    EXPECT_GT(attribute["coordinate_bytes_most"], 0);
    EXPECT_GT(uniform["mesh_draws"]["max"], table["mesh_draws"]["max"]);
    // The builder puts every place where a packed coordinate can say it.
    for (const auto& pages : {table, uniform, attribute, packed}) EXPECT_EQ(pages["fallback_tiles_most"], 0);
    EXPECT_GT(packed["coordinate_bytes_most"], 0);
    EXPECT_LT(packed["coordinate_bytes_most"], 0.7 * attribute["coordinate_bytes_most"].get<double>())
        << "7 words a triangle instead of 12";
}

TEST(ChartTransportFlight, AnUnknownTransportIsWrongUsage) {
    const Outcome flown =
        run({program("citystream-fly"), "city.3tz", "--path", "path.csv", "--chart-transport", "carrier-pigeon"});
    EXPECT_EQ(flown.exit_code, 2);
    EXPECT_NE(flown.error.find("--chart-transport"), std::string::npos) << flown.error;
}

}  // namespace
}  // namespace citystream::tests
