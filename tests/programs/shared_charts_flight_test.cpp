// Flights of the real programs over a city whose pictures are shared by its tiles, and over the same city without: the
// same bounds, fewer bytes; and what is not shared costs nothing.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/render/frame_file.h"
#include "client/report/image_metrics.h"
#include "tests/programs/flown_frames.h"
#include "tests/programs/program_runner.h"
#include "tests/programs/street_path.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;

constexpr const char *kLarge = "1280x720", *kSmall = "480x270";

/// The 300-building city with pictures shared ("on", with its reference beside it) or not ("off").
const std::string& city(bool shared) {
    static const TemporaryFolder folder;
    static const auto build = [](const std::string& way) {
        std::string archive = folder / (way + ".3tz");
        std::vector<std::string> command = {
            program("citystream-build"), "generate", "--buildings", "300",  "--seed", "7",
            "--shared-charts",           way,        "-o",          archive};
        if (way == "on") command.insert(command.end(), {"--reference", folder / "on.glb"});
        const Outcome built = run(command);
        EXPECT_EQ(built.exit_code, 0) << built.error;
        return archive;
    };
    static const std::string cities[2] = {build("off"), build("on")};
    return cities[shared ? 1 : 0];
}

Flown fly(const std::string& place, const std::string& size, const std::vector<std::string>& more = {}) {
    return fly_three_frames(place, path_to_street(7, 300, -260, 170), size, more);
}

TEST(SharedChartsFlight, FramesAgreeWithTheReferenceAndCostFewerBytesThanWithoutSharing) {
    const Flown off = fly(city(false), kLarge), on = fly(city(true), kLarge);
    std::string glb = city(true);
    glb.replace(glb.size() - 3, 3, "glb");
    const Flown reference = fly(glb, kLarge, {"--reference", glb});
    ASSERT_EQ(reference.frames.size(), 3u);
    ASSERT_EQ(on.frames.size(), 3u);
    ASSERT_EQ(off.frames.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        const double shared = client::psnr(reference.frames[i], on.frames[i]);
        EXPECT_GE(shared, 35) << "frame " << i;
        EXPECT_GE(shared, client::psnr(reference.frames[i], off.frames[i]) - 0.5) << "frame " << i;
    }
    EXPECT_GT(on.summary["charts"]["level_bytes"], 0);
    EXPECT_GT(on.summary["charts"]["shared_most"], 10);
    EXPECT_LT(on.summary["bytes"]["wire"], off.summary["bytes"]["wire"]);
    EXPECT_LT(on.summary["bytes"]["gpu_max"], off.summary["bytes"]["gpu_max"]);
    EXPECT_EQ(on.summary["tiles_missing"], 0);
}

TEST(SharedChartsFlight, ACityWithoutSharedChartsFetchesAndBindsNothingOfADictionary) {
    const Json charts = fly(city(false), kSmall).summary["charts"];
    EXPECT_EQ(charts["dictionary_bytes"], 0);
    EXPECT_EQ(charts["shared_most"], 0);
    const Outcome listed = run({"unzip", "-l", city(false)});
    EXPECT_EQ(listed.output.find("charts/"), std::string::npos);
}

TEST(SharedChartsFlight, SmallBudgetsAreHeld) {
    const Json small = fly(city(true), kSmall, {"--gpu-budget", "600KiB", "--host-budget", "8MiB"}).summary;
    EXPECT_LE(small["bytes"]["gpu_max"], 600 << 10);
    EXPECT_LE(small["bytes"]["host_max"], 8 << 20);
    EXPECT_GT(small["tolerance_used_max"], 1.0) << "the budget was never felt: the test is too easy";
    EXPECT_GT(small["charts"]["shared_most"], 0);
}

TEST(SharedChartsFlight, LoadClientsReplayIt) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", path_to_street(7, 300, -260, 170));
    const Background server({program("citystream-serve"), city(true), "--listen", "127.0.0.1:0"}, "listening on");
    const std::string url = url_in(server.ready_line());
    ASSERT_NE(url, "");
    const Flown flown = fly(url, kSmall);
    const Outcome load = run({program("citystream-load"), url, "--path", folder / "path.csv", "--clients", "3",
                              "--duration", "4", "--ramp", "0.1", "--json"});
    ASSERT_EQ(load.exit_code, 0) << load.error;
    const Json replayed = Json::parse(load.output);
    EXPECT_EQ(replayed["errors"], 0);
    EXPECT_TRUE(replayed["warnings"].empty()) << replayed["warnings"].dump();
    EXPECT_GT(replayed["updates"]["complete"], 0);
    EXPECT_GE(replayed["over_fetch"], 1.0);
    EXPECT_GE(replayed["bytes"]["layers"], flown.summary["charts"]["level_bytes"]);
}

}  // namespace
}  // namespace citystream::tests
