// Flights of the real programs over a generated city: the same frames from everywhere, equal to the reference, within
// the budgets.

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/render/frame_file.h"
#include "client/report/image_metrics.h"
#include "tests/programs/program_runner.h"
#include "tiles/city/generator_layout.h"

namespace citystream::tests {
namespace {

using client::FrameImage;
using tiles::city::procedural::Axis;
using tiles::city::procedural::CityPlan;
using tiles::city::procedural::kMetre;

constexpr const char* kHeader = "t,x,y,z,yaw,pitch,fov\n";

/// A camera in the middle of a main street of the shared city (300 buildings, seed 7), `height` metres above the
/// ground.
std::string camera_line(double t, double along, double height, double yaw, double pitch, double shift = 0) {
    const CityPlan plan(7, 300);
    const auto x = plan.line(Axis::kX, 0).axis, y = static_cast<int64_t>(along * kMetre);
    const double ground = static_cast<double>(plan.ground(x, y)) / kMetre;
    return fmt::format("{},{},{},{},{},{},60\n", t, static_cast<double>(x) / kMetre + shift, along + shift,
                       ground + height, yaw, pitch);
}

std::string street_path(double shift = 0) {
    return kHeader + camera_line(0, -60, 1.7, 0, 2, shift) + camera_line(1, -40, 1.7, 25, 5, shift) +
           camera_line(2, -20, 1.8, -30, 8, shift);
}
std::string roof_path(double shift = 0) {
    return kHeader + camera_line(0, -80, 28, 10, -12, shift) + camera_line(1, -50, 30, -50, -15, shift) +
           camera_line(2, -20, 32, 120, -10, shift);
}
std::string high_path(double shift = 0) {
    return kHeader + camera_line(0, -260, 170, 0, -25, shift) + camera_line(1, -200, 200, 15, -40, shift) +
           camera_line(2, 0, 260, 80, -70, shift);
}

std::vector<std::string> fly_command(const std::string& place, const std::string& path, const std::string& frames) {
    return {program("citystream-fly"), place, "--path", path, "--frames", frames, "--fps", "1", "--validation"};
}

const std::vector<std::string> kSmall = {"--size", "480x270"};
const std::vector<std::string> kLarge = {"--size", "1280x720"};

std::vector<FrameImage> frames_of(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".png") names.push_back(entry.path().string());
    std::sort(names.begin(), names.end());
    std::vector<FrameImage> frames;
    for (const std::string& name : names) {
        auto frame = client::read_png(name);
        EXPECT_TRUE(frame) << name;
        if (frame) frames.push_back(std::move(frame).value());
    }
    return frames;
}

std::vector<FrameImage> fly(const std::string& place, const std::string& path,
                            const std::vector<std::string>& more = {}, const std::vector<std::string>& size = kSmall) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", path);
    auto command = fly_command(place, folder / "path.csv", folder / "frames");
    command.insert(command.end(), size.begin(), size.end());
    command.insert(command.end(), more.begin(), more.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.exit_code == 0 ? frames_of(folder / "frames") : std::vector<FrameImage>{};
}

void expect_same(const std::vector<FrameImage>& a, const std::vector<FrameImage>& b) {
    ASSERT_EQ(a.size(), b.size());
    ASSERT_FALSE(a.empty());
    for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].rgba, b[i].rgba) << "frame " << i;
}

TEST(Flight, FramesAreTheSameFromFileServerFolderAndPlainStaticServer) {
    const auto from_file = fly(shared_city(), roof_path());
    const Background server({program("citystream-serve"), shared_city(), "--listen", "127.0.0.1:0"}, "listening on");
    ASSERT_NE(server.ready_line(), "");
    expect_same(from_file, fly(url_in(server.ready_line()), roof_path()));

    const TemporaryFolder folder;
    const Outcome unpacked = run({"unzip", "-q", shared_city(), "-d", folder / "city"});
    ASSERT_LE(unpacked.exit_code, 1) << unpacked.error;
    expect_same(from_file, fly(folder / "city", roof_path()));
    const Background plain(
        {"python3", "-u", "-m", "http.server", "0", "--bind", "127.0.0.1", "--directory", folder.path().string()},
        "Serving HTTP");
    const std::string url = url_in(plain.ready_line());
    ASSERT_NE(url, "") << plain.ready_line();
    expect_same(from_file, fly(url + (url.back() == '/' ? "" : "/") + "city", roof_path()));
}

TEST(Flight, EveryFrameAgreesWithTheReferenceRenderer) {
    std::string glb = shared_city();
    glb.replace(glb.size() - 3, 3, "glb");
    ASSERT_TRUE(std::filesystem::exists(glb));
    for (const auto& [name, path] :
         {std::pair{"street", street_path()}, {"roof", roof_path()}, {"high", high_path()}}) {
        const auto frames = fly(shared_city(), path, {}, kLarge),
                   reference = fly(shared_city(), path, {"--reference", glb}, kLarge);
        ASSERT_EQ(frames.size(), reference.size());
        ASSERT_EQ(frames.size(), 3u);
        for (size_t i = 0; i < frames.size(); ++i)
            EXPECT_GE(client::psnr(reference[i], frames[i]), 35) << name << " frame " << i;
    }
}

TEST(Flight, WhatNearHousesHideIsLeftOutAndNoPixelChanges) {
    const TemporaryFolder folder;
    std::string path = kHeader;
    for (int i = 0; i < 8; ++i) path += camera_line(i, -60 + 40 * i, 1.7, 45 * i, 3);
    const auto tiles = [](const std::string& file) {
        std::array<uint64_t, 2> drawn_and_hidden{};
        const auto statistics = nlohmann::json::parse(read_file(file));
        for (const auto& frame : statistics["frames"]) {
            drawn_and_hidden[0] += frame["tiles"]["drawn"].get<uint64_t>();
            drawn_and_hidden[1] += frame["tiles"]["hidden"].get<uint64_t>();
        }
        return drawn_and_hidden;
    };
    const auto seen = fly(shared_city(), path, {"--stats", folder / "on.json"});
    const auto all = fly(shared_city(), path, {"--occlusion", "off", "--stats", folder / "off.json"});
    ASSERT_EQ(seen.size(), 8U);
    ASSERT_EQ(all.size(), 8U);
    for (size_t i = 0; i < all.size(); ++i) EXPECT_GT(client::psnr(all[i], seen[i]), 70) << "frame " << i;
    const auto [drawn, hidden] = tiles(folder / "on.json");
    const auto [all_drawn, none_hidden] = tiles(folder / "off.json");
    EXPECT_GT(hidden, 0U);
    EXPECT_EQ(none_hidden, 0U);
    EXPECT_LT(drawn, all_drawn);
}

TEST(Flight, ACityMovedByTenThousandKilometresGivesTheSameFrames) {
    const TemporaryFolder folder;
    const Outcome built = run({program("citystream-build"), "generate", "--buildings", "300", "--seed", "7", "--origin",
                               "10000000,10000000", "-o", folder / "moved.3tz"});
    ASSERT_EQ(built.exit_code, 0) << built.error;
    for (const auto& [here, there] : {std::pair{street_path(), street_path(1e7)}, {high_path(), high_path(1e7)}}) {
        const auto at_origin = fly(shared_city(), here), moved = fly(folder / "moved.3tz", there);
        ASSERT_EQ(at_origin.size(), moved.size());
        ASSERT_FALSE(moved.empty());
        for (size_t i = 0; i < moved.size(); ++i) EXPECT_GT(client::psnr(at_origin[i], moved[i]), 60) << "frame " << i;
    }
}

TEST(Flight, SmallBudgetsAreNeverExceededAndTheErrorIsReported) {
    const TemporaryFolder folder;
    write_file(folder / "path.csv", street_path());
    auto command = fly_command(shared_city(), folder / "path.csv", folder / "frames");
    command.insert(command.end(), {"--size", "480x270", "--gpu-budget", "2MiB", "--host-budget", "16MiB", "--stats",
                                   folder / "stats.json"});
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto statistics = nlohmann::json::parse(read_file(folder / "stats.json"));
    ASSERT_EQ(statistics["frames"].size(), 3u);
    for (const auto& frame : statistics["frames"]) {
        EXPECT_LE(frame["bytes"]["gpu"].get<uint64_t>(), uint64_t{2} << 20);
        EXPECT_LE(frame["bytes"]["host"].get<uint64_t>(), uint64_t{16} << 20);
        EXPECT_GT(frame["achieved_error_pixels"].get<double>(), 0);
        EXPECT_GT(frame["tiles"]["drawn"].get<uint64_t>(), 0u);
    }
    EXPECT_EQ(frames_of(folder / "frames").size(), 3u);
}

TEST(Flight, SurvivesAServerThatDiesAndComesBack) {
    const TemporaryFolder folder;
    auto server = std::make_unique<Background>(
        std::vector<std::string>{program("citystream-serve"), shared_city(), "--listen", "127.0.0.1:0"},
        "listening on");
    const std::string url = url_in(server->ready_line());
    ASSERT_NE(url, "");
    const std::string address = url.substr(7, url.find('/', 7) == std::string::npos ? url.npos : url.find('/', 7) - 7);
    std::thread accident([&] {
        usleep(700 * 1000);
        server->stop(SIGKILL);
        usleep(700 * 1000);
        server = std::make_unique<Background>(
            std::vector<std::string>{program("citystream-serve"), shared_city(), "--listen", address}, "listening on");
    });
    const auto frames = fly(url, street_path(), {"--network", "8mbit,20ms"});
    accident.join();
    EXPECT_NE(server->ready_line(), "");
    expect_same(fly(shared_city(), street_path()), frames);
}

TEST(Flight, RefiningMovesOnlyRangesAndAStaticCameraAsksForNothing) {
    const TemporaryFolder folder;
    std::string path = kHeader;
    for (int i = 0; i < 4; ++i) path += camera_line(i, -40, 2, 0, 0);
    write_file(folder / "path.csv", path);
    auto command = fly_command(shared_city(), folder / "path.csv", folder / "frames");
    command.insert(command.end(), {"--size", "480x270", "--stats", folder / "stats.json"});
    ASSERT_EQ(run(command).exit_code, 0);
    const auto statistics = nlohmann::json::parse(read_file(folder / "stats.json"));
    ASSERT_GE(statistics["frames"].size(), 3u);
    EXPECT_GT(statistics["frames"][0]["requests"].get<uint64_t>(), 0u);
    for (size_t i = 1; i < statistics["frames"].size(); ++i)
        EXPECT_EQ(statistics["frames"][i]["requests"].get<uint64_t>(), 0u) << "frame " << i;
}

}  // namespace
}  // namespace citystream::tests
