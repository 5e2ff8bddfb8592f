// Bad input to the programs: one clear line, exit code 1 (2 for wrong usage), nothing left behind.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>

#include "client/render/frame_file.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

constexpr const char* kPath = "t,x,y,z,yaw,pitch,fov\n0,100,100,60,45,-20,60\n1,120,120,60,45,-20,60\n";

/// Two walls, each with a picture of its own.
constexpr const char* kTwoWalls = R"({"type":"CityJSON","version":"2.0",
"transform":{"scale":[1,1,1],"translate":[500,500,0]},
"vertices":[[0,0,0],[8,0,0],[8,0,6],[0,0,6],[20,0,0],[28,0,0],[28,0,6],[20,0,6]],
"appearance":{"textures":[{"type":"PNG","image":"whole.png"},{"type":"PNG","image":"cut.png"}],
"vertices-texture":[[0,0],[1,0],[1,1],[0,1]]},
"CityObjects":{
"a":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2,3]]],
"texture":{"t":{"values":[[[0,0,1,2,3]]]}}}]},
"b":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[4,5,6,7]]],
"texture":{"t":{"values":[[[1,0,1,2,3]]]}}}]}}})";

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

/// A command whose `option` has a bad value is wrong usage: one line that names the program and the option.
void expect_wrong_value(const std::vector<std::string>& command, const std::string& option) {
    const Outcome outcome = run(command);
    expect_one_clear_line(outcome, 2);
    const std::string name = std::filesystem::path(command.front()).filename().string();
    EXPECT_TRUE(outcome.error.starts_with(name + ": ")) << outcome.error;
    EXPECT_NE(outcome.error.find(option), std::string::npos) << outcome.error;
}

TEST(BadInput, NumbersThatAreNoneAreWrongUsage) {
    const TemporaryFolder folder;
    const std::vector<std::string> fly = {program("citystream-fly"), "a.3tz", "--path", "a.csv"},
                                   load = {program("citystream-load"), "a.3tz", "--path", "a.csv", "--clients", "1"},
                                   report = {program("citystream-report"),
                                             "a.3tz",
                                             "--path",
                                             "a.csv",
                                             "-o",
                                             folder / "report"};
    const auto refuse = [](std::vector<std::string> command, const std::string& option, const std::string& value) {
        command.insert(command.end(), {option, value});
        expect_wrong_value(command, option);
    };
    // What else is no number: tests/command_line.
    for (const char* option :
         {"--tolerance", "--relief-tolerance", "--texel-tolerance", "--position-tolerance", "--fps", "--supersample"})
        refuse(fly, option, "nan");
    for (const char* option : {"--tolerance", "--relief-tolerance", "--rate"}) refuse(load, option, "nan");
    for (const char* option : {"--tolerance", "--relief-tolerance", "--texel-tolerance", "--position-tolerance",
                               "--tolerances", "--relief-tolerances", "--position-tolerances", "--gpu-budgets"})
        refuse(report, option, "nan");
    refuse(report, "--texel-tolerances", "1,nan,2");
    refuse(fly, "--facade-samples", "x");
    for (const auto& command : {fly, load, report}) refuse(command, "--size", "1280x720junk");
}

TEST(BadInput, ReportRefusesSettingsThatItCannotBuildOrName) {
    const TemporaryFolder folder;
    const std::vector<std::string> report = {
        program("citystream-report"), "a.3tz", "--path", "a.csv", "-o", folder / "report"};
    const auto refuse = [&](const std::vector<std::string>& more, const std::string& option) {
        std::vector<std::string> command = report;
        command.insert(command.end(), more.begin(), more.end());
        expect_wrong_value(command, option);
    };
    refuse({"--saliencies", "ssim:nan", "--", "generate"}, "--saliencies");
    refuse({"--rate-distortions", "-1", "--", "generate"}, "--rate-distortions");
    refuse({"--mesh-transports", "post", "--", "generate"}, "--mesh-transports");
    refuse({"--normal-bits", "16,33", "--", "generate"}, "--normal-bits");
    refuse({"--mesh-topologies", "fan", "--", "generate"}, "--mesh-topologies");
    refuse({"--precisions", "double", "--", "generate"}, "--precisions");
    refuse({"--mesh-steps", "0", "--", "generate"}, "--mesh-steps");
    refuse({"--also", "nameless.3tz"}, "--also");
    const auto refuse_light = [&](std::vector<std::string> more, const std::string& option) {
        more.insert(more.begin(), {"--environment", "sky"});
        refuse(more, option);
    };
    refuse_light({"--lattices", "4,3", "--", "generate"}, "--lattices");
    refuse_light({"--directions", "65", "--", "generate"}, "--directions");
    refuse_light({"--local-directions", "0", "--", "generate"}, "--local-directions");
    refuse_light({"--lattices", "4"}, "--lattices");
    refuse_light({"--radiance-transports", "post", "--", "generate"}, "--radiance-transports");
    refuse_light({"--radiance-transports", "rows"}, "--radiance-transports");
    refuse_light({"--light-tolerances", "0.1,2"}, "--light-tolerances");
    refuse_light({"--matrices", "dense"}, "--matrices");
    refuse_light({"--matrix-errors", "nan"}, "--matrix-errors");
    refuse_light({"--reference-rays", "0"}, "--reference-rays");
    refuse_light({"--exposure", "bright"}, "--exposure");
    refuse_light({"--sun", "moon"}, "--sun");
    refuse_light({"--hour", "25"}, "--hour");
    refuse({"--light-tolerances", "0.1"}, "--environment");
    refuse({"--matrices", "rows"}, "--environment");
    refuse({"--reference-rays", "64"}, "--environment");
    refuse({"--hour", "12"}, "--hour");
    EXPECT_FALSE(std::filesystem::exists(folder / "report"));
}

TEST(BadInput, BuilderNamesTheOptionWhoseValueIsWrong) {
    const TemporaryFolder folder;
    const std::vector<std::vector<std::string>> wrong = {{"--textures", "-3"},
                                                         {"--texture-law", "0.02,1,8"},
                                                         {"--mesh-transport", "post"},
                                                         {"--normal-bits", "17"},
                                                         {"--normal-bits", "34"},
                                                         {"--mesh-topology", "fan"},
                                                         {"--precision", "double"},
                                                         {"--mesh-steps", "5"},
                                                         {"--texture-law", "nan"},
                                                         {"--memory-limit", "nan"},
                                                         {"--origin", "nan,0"},
                                                         {"--lattice", "3", "--layers", "mesh,radiance"},
                                                         {"--lattice", "32", "--layers", "mesh,radiance"},
                                                         {"--directions", "65", "--layers", "mesh,radiance"},
                                                         {"--local-directions", "0", "--layers", "mesh,radiance"},
                                                         {"--lattice", "4"},
                                                         {"--rebake"},
                                                         {"--page-mips", "2"},
                                                         {"--page-shape", "tight"},
                                                         {"--shared-charts", "on", "--atlas-form", "pages"},
                                                         {"--page-mips", "8", "--atlas-form", "pages"},
                                                         {"--aerial", "rgb.png,0,0,nan,100"},
                                                         {"--aerial", "rgb.png,0,0,100"},
                                                         {"--aerial", "rgb.png,0,0,0,100"}};
    for (const std::vector<std::string>& option : wrong) {
        std::vector<std::string> command = {program("citystream-build"), "generate", "-o", folder / "out.3tz"};
        command.insert(command.end(), option.begin(), option.end());
        expect_wrong_value(command, option.front());
    }
    const Outcome one =
        run({program("citystream-build"), "generate", "-o", folder / "out.3tz", "--texture-law", "0.02,1,8"});
    EXPECT_NE(one.error.find("a factor of 1, not more than 1 and at most 256"), std::string::npos) << one.error;
    const Outcome absent =
        run({program("citystream-build"), "generate", "-o", folder / "out.3tz", "--aerial", "rgb.png"});
    expect_one_clear_line(absent, 1);
    EXPECT_FALSE(std::filesystem::exists(folder / "out.3tz"));
}

TEST(BadInput, ImagesThatCannotBeReadAreALineEachAndNoneOfThoseShown) {
    const TemporaryFolder folder;
    client::FrameImage image{64, 64, std::vector<uint8_t>(size_t{4} * 64 * 64, 255)};
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        if (i % 4 != 3) image.rgba[i] = static_cast<uint8_t>(i * i / 7);
    }
    ASSERT_TRUE(client::write_png(folder / "whole.png", image));
    const std::string bytes = read_file(folder / "whole.png");
    write_file(folder / "cut.png", bytes.substr(0, bytes.size() / 2));
    write_file(folder / "city.json", kTwoWalls);
    const Outcome built = run({program("citystream-build"), folder / "city.json", "-o", folder / "out.3tz"});
    EXPECT_EQ(built.exit_code, 0) << built.error;
    EXPECT_EQ(built.error.find("libpng"), std::string::npos) << built.error;
    EXPECT_NE(built.error.find("cut.png"), std::string::npos) << built.error;
    EXPECT_EQ(std::count(built.error.begin(), built.error.end(), '\n'), 2) << "the image and the sum" << built.error;
    EXPECT_NE(built.output.find("1 of 2 shown, 1 could not be read"), std::string::npos) << built.output;
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
