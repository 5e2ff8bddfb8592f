// Bad input to the programs: one clear line, exit code 1 (2 for wrong usage), nothing left behind.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

constexpr const char* kPath = "t,x,y,z,yaw,pitch,fov\n0,100,100,60,45,-20,60\n1,120,120,60,45,-20,60\n";

void expect_one_clear_line(const Outcome& outcome, int exit_code) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.output << outcome.error;
    EXPECT_FALSE(outcome.error.empty());
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
}

TEST(BadInput, WrongUsageIsExitCodeTwo) {
    for (const char* name :
         {"citystream-build", "citystream-serve", "citystream-fly", "citystream-load", "citystream-report"}) {
        EXPECT_EQ(run({program(name), "--no-such-option"}).exit_code, 2) << name;
        EXPECT_EQ(run({program(name), "--help"}).exit_code, 0) << name;
        EXPECT_EQ(run({program(name), "--version"}).exit_code, 0) << name;
        EXPECT_NE(run({program(name), "--help"}).output.find("citystream"), std::string::npos) << name;
    }
}

TEST(BadInput, BuilderRefusesWhatIsNoCity) {
    const TemporaryFolder folder;
    write_file(folder / "noise.json", "this is no city");
    write_file(folder / "empty.json", "");
    write_file(
        folder / "zero.json",
        R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{},"vertices":[]})");
    write_file(folder / "cut.json", R"({"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"transla)");
    for (const char* name : {"noise.json", "empty.json", "zero.json", "cut.json", "absent.json"}) {
        expect_one_clear_line(run({program("citystream-build"), folder / name, "-o", folder / "out.3tz"}), 1);
        EXPECT_FALSE(std::filesystem::exists(folder / "out.3tz")) << name;
    }
}

TEST(BadInput, ProgramsRefuseDamagedOrMissingArchives) {
    const TemporaryFolder folder;
    const std::string whole = read_file(shared_city());
    ASSERT_GT(whole.size(), 1000u);
    write_file(folder / "cut.3tz", whole.substr(0, whole.size() / 2));
    write_file(folder / "noise.3tz", std::string(5000, 'x'));
    write_file(folder / "path.csv", kPath);
    for (const char* name : {"cut.3tz", "noise.3tz", "absent.3tz"}) {
        expect_one_clear_line(run({program("citystream-build"), "info", folder / name}), 1);
        expect_one_clear_line(run({program("citystream-build"), "verify", folder / name}), 1);
        expect_one_clear_line(run({program("citystream-serve"), folder / name, "--listen", "127.0.0.1:0"}), 1);
        expect_one_clear_line(run({program("citystream-fly"), folder / name, "--path", folder / "path.csv"}), 1);
    }
}

TEST(BadInput, VerifyNamesTheDamagedTileAndLayer) {
    const TemporaryFolder folder;
    std::string bytes = read_file(shared_city());
    const size_t name = bytes.find("tiles/0/0/0.mesh");
    ASSERT_NE(name, std::string::npos);
    bytes[name + 200] = static_cast<char>(bytes[name + 200] ^ 0x10);
    write_file(folder / "damaged.3tz", bytes);
    const Outcome outcome = run({program("citystream-build"), "verify", folder / "damaged.3tz"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE((outcome.error + outcome.output).find(".mesh"), std::string::npos) << outcome.error << outcome.output;
}

TEST(BadInput, FlyRefusesBadPathsAndUnknownPlaces) {
    const TemporaryFolder folder;
    write_file(folder / "headless.csv", "1,2,3\n");
    write_file(folder / "word.csv", "t,x,y,z,yaw,pitch,fov\n0,1,2,3,north,0,60\n");
    write_file(folder / "good.csv", kPath);
    expect_one_clear_line(run({program("citystream-fly"), shared_city(), "--path", folder / "headless.csv"}), 1);
    expect_one_clear_line(run({program("citystream-fly"), shared_city(), "--path", folder / "word.csv"}), 1);
    expect_one_clear_line(run({program("citystream-fly"), shared_city(), "--path", folder / "absent.csv"}), 1);
    expect_one_clear_line(run({program("citystream-fly"), "http://127.0.0.1:1/city", "--path", folder / "good.csv"}),
                          1);
    const Background server({program("citystream-serve"), shared_city(), "--listen", "127.0.0.1:0"}, "listening on");
    ASSERT_NE(server.ready_line(), "");
    expect_one_clear_line(
        run({program("citystream-fly"), url_in(server.ready_line()) + "/atlantis", "--path", folder / "good.csv"}), 1);
}

TEST(BadInput, AKilledBuildLeavesNothingUnderTheFinalName) {
    const TemporaryFolder folder;
    for (const int signal : {SIGKILL, SIGTERM, SIGINT}) {
        Background build({program("citystream-build"), "generate", "--buildings", "20000", "--seed", "3", "-o",
                          folder / "killed.3tz"},
                         "never printed", 2);
        EXPECT_EQ(build.ready_line(), "");
        build.stop(signal);
        EXPECT_FALSE(std::filesystem::exists(folder / "killed.3tz"));
    }
}

}  // namespace
}  // namespace citystream::tests
