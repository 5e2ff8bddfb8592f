// Flights through a city with a radiance layer, as a user makes them: with light, and without any of it.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;

constexpr const char* kPath = "t,x,y,z,yaw,pitch,fov\n0,-40,-40,40,45,-25,60\n1,-30,-40,40,40,-20,60\n";
constexpr const char* kTurning = "time_s,environment,rotation_degrees,hour\n0,sky,0,9\n1,sky,90,12\n";

/// A few houses, baked coarsely.
struct LitCity {
    LitCity() {
        write_file(path, kPath);
        write_file(turning, kTurning);
        build(lit, {"--layers", "mesh,facade,atlas,radiance", "--lattice", "8", "--directions", "8"});
        build(dark, {});
    }
    void build(const std::string& file, std::vector<std::string> more) const {
        std::vector<std::string> command = {
            program("citystream-build"), "generate", "--buildings", "8", "--seed", "1", "-o", file};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome built = run(command);
        EXPECT_EQ(built.exit_code, 0) << built.error;
    }
    Outcome fly(const std::string& city, std::vector<std::string> more) const {
        std::vector<std::string> command = {
            program("citystream-fly"), city, "--path", path, "--size", "160x90", "--fps", "2", "--json"};
        command.insert(command.end(), more.begin(), more.end());
        return run(command);
    }
    TemporaryFolder folder;
    std::string path = folder / "path.csv", turning = folder / "turning.csv", lit = folder / "lit.3tz",
                dark = folder / "dark.3tz";
};

const LitCity& city() {
    static const LitCity instance;
    return instance;
}

Json summary_of(const Outcome& outcome) {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    const Json json = Json::parse(outcome.output, nullptr, false);
    EXPECT_FALSE(json.is_discarded()) << outcome.output;
    return json.is_discarded() ? Json::object() : json["summary"];
}

TEST(LightFlight, WithoutAnEnvironmentNothingOfItIsAskedForOrMade) {
    const Outcome outcome = city().fly(city().lit, {"--frames", city().folder / "unlit"});
    const Json summary = summary_of(outcome);
    EXPECT_EQ(summary["bytes"]["layers"]["radiance"], 0);
    const Json& light = summary["light"];
    EXPECT_EQ(light["pipeline"], false);
    for (const char* count : {"layers_most", "decodes", "pass_frames", "pass_tiles", "pass_receivers"})
        EXPECT_EQ(light[count], 0) << count;
    // The city that never had the layer, to the byte.
    const Json dark = summary_of(city().fly(city().dark, {"--frames", city().folder / "dark"}));
    EXPECT_EQ(dark["bytes"]["frame_buffers"], summary["bytes"]["frame_buffers"]);
    for (const char* frame : {"/frame_00000.png", "/frame_00002.png"})
        EXPECT_EQ(read_file((city().folder / "unlit") + frame), read_file((city().folder / "dark") + frame));
}

TEST(LightFlight, ASteadySkyLightsEachTileOnceAndAChangingOneEachFrame) {
    const Json steady = summary_of(city().fly(city().lit, {"--environment", "sky", "--hour", "9"}));
    EXPECT_GT(steady["bytes"]["layers"]["radiance"], 0);
    EXPECT_EQ(steady["light"]["pipeline"], true);
    EXPECT_EQ(steady["light"]["pass_frames"], 1);
    EXPECT_GT(steady["light"]["pass_receivers"], 100);
    EXPECT_EQ(steady["light"]["tiles"]["median"], steady["tiles_drawn"]["median"]);
    const Json turning = summary_of(city().fly(city().lit, {"--environment-path", city().turning}));
    EXPECT_EQ(turning["light"]["pass_frames"], turning["frames"]);
    EXPECT_EQ(turning["light"]["decodes"], steady["light"]["decodes"]);
    EXPECT_EQ(turning["bytes"]["layers"]["radiance"], steady["bytes"]["layers"]["radiance"]);
}

TEST(LightFlight, PicturesFollowTheHourAndBothFormsOfTheMatrixShowTheSame) {
    const auto frame = [](const std::vector<std::string>& more, const std::string& name) {
        std::vector<std::string> arguments = {"--environment",     "sky", "--exposure", "-5", "--frames",
                                              city().folder / name};
        arguments.insert(arguments.end(), more.begin(), more.end());
        summary_of(city().fly(city().lit, arguments));
        return read_file((city().folder / name) + "/frame_00001.png");
    };
    const std::string noon = frame({"--hour", "12"}, "noon");
    EXPECT_EQ(noon, frame({"--hour", "12", "--matrix", "rows"}, "rows"));
    EXPECT_NE(noon, frame({"--hour", "19"}, "evening"));
}

TEST(LightFlight, ReliefShadesItselfWhereThatIsAskedForWithinTheBudgetOfBtfs) {
    const auto fly = [](const std::vector<std::string>& more, const std::string& name) {
        std::vector<std::string> arguments = {"--environment", "sky", "--hour", "9", "--frames", city().folder / name};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return summary_of(city().fly(city().lit, arguments))["light"];
    };
    const Json off = fly({}, "relief_off");
    for (const char* count : {"local_bytes_most", "masks_most", "mask_bytes_most", "btfs_most", "btf_bytes_most"})
        EXPECT_EQ(off[count], 0) << count;
    const Json on = fly({"--meso", "on", "--btf-budget", "4MiB"}, "relief_on");
    EXPECT_GT(on["local_bytes_most"], 0);
    EXPECT_GT(on["btfs_most"], 0);
    EXPECT_LE(on["btf_bytes_most"], 4 << 20);
    EXPECT_GE(on["masks_most"], on["btfs_most"]);
    EXPECT_GT(on["facades_by_btf"], 0);
    const auto frame = [](const std::string& name) { return read_file((city().folder / name) + "/frame_00001.png"); };
    EXPECT_NE(frame("relief_on"), frame("relief_off"));
}

TEST(LightFlight, ACityWithoutTheLayerIsLitByTheSkyAndSaysSo) {
    const Outcome outcome = city().fly(city().dark, {"--environment", "sky"});
    const Json summary = summary_of(outcome);
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
    EXPECT_NE(outcome.error.find("no radiance layer"), std::string::npos) << outcome.error;
    EXPECT_EQ(summary["light"]["pass_tiles"], 0);
    EXPECT_EQ(summary["light"]["tiles"]["max"], 0);
}

TEST(LightFlight, WhatIsWrongWithTheLightIsOneClearLine) {
    const auto refuse = [](const std::vector<std::string>& more, int exit_code, const std::string& named) {
        const Outcome outcome = city().fly(city().lit, more);
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.error;
        EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
        EXPECT_NE(outcome.error.find(named), std::string::npos) << outcome.error;
    };
    refuse({"--environment", "sky", "--environment-path", city().turning}, 2, "--environment-path");
    refuse({"--environment", "sky", "--exposure", "bright"}, 2, "--exposure");
    refuse({"--environment", "sky", "--light-tolerance", "nan"}, 2, "--light-tolerance");
    refuse({"--environment", "sky", "--matrix", "dense"}, 2, "--matrix");
    refuse({"--light-tolerance", "0.1"}, 2, "--light-tolerance");
    refuse({"--matrix", "rows"}, 2, "--matrix");
    refuse({"--matrix-error", "0.1"}, 2, "--matrix-error");
    refuse({"--meso", "on"}, 2, "--meso");
    refuse({"--btf-budget", "8MiB"}, 2, "--btf-budget");
    refuse({"--environment", "sky", "--btf-budget", "much"}, 2, "--btf-budget");
    refuse({"--environment", "sky", "--reference", "a.glb"}, 2, "--reference");
    refuse({"--environment", "/nowhere/dawn.exr"}, 1, "/nowhere/dawn.exr");
    const std::string text = city().folder / "text.exr";
    write_file(text, "no picture");
    refuse({"--environment", text}, 1, text);
}

TEST(LightFlight, LoadClientsCountItWhereAsked) {
    const auto load = [](const std::vector<std::string>& more) {
        std::vector<std::string> command = {program("citystream-load"),
                                            city().lit,
                                            "--path",
                                            city().path,
                                            "--clients",
                                            "1",
                                            "--ramp",
                                            "0",
                                            "--duration",
                                            "2s",
                                            "--json"};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
        return Json::parse(outcome.output, nullptr, false);
    };
    const Json without = load({}), with = load({"--light-tolerance", "0.05"});
    EXPECT_GT(with["bytes"]["layers"].get<uint64_t>(), without["bytes"]["layers"].get<uint64_t>() + 1000);
}

}  // namespace
}  // namespace citystream::tests
