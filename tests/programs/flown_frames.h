// What citystream-fly makes of a short path: its summary and frames.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "client/render/frame_file.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {

struct Flown {
    nlohmann::json summary;
    std::vector<client::FrameImage> frames;
};

/// Flies a path at a frame a second, validation on, into `folder`; the statistics, null where there are none. `more`:
/// further options.
inline nlohmann::json fly_into(const TemporaryFolder& folder, const std::string& place, const std::string& path,
                               const std::string& size, const std::vector<std::string>& more) {
    write_file(folder / "path.csv", path);
    std::vector<std::string> command = {program("citystream-fly"),
                                        place,
                                        "--path",
                                        folder / "path.csv",
                                        "--fps",
                                        "1",
                                        "--size",
                                        size,
                                        "--stats",
                                        folder / "s",
                                        "--validation"};
    command.insert(command.end(), more.begin(), more.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    if (outcome.exit_code != 0 || !std::filesystem::exists(folder / "s")) return {};
    return nlohmann::json::parse(read_file(folder / "s"));
}

/// The same of a path of three cameras, with their frames.
inline Flown fly_three_frames(const std::string& place, const std::string& path, const std::string& size,
                              std::vector<std::string> more) {
    const TemporaryFolder folder;
    more.insert(more.end(), {"--frames", folder / "frames"});
    const nlohmann::json statistics = fly_into(folder, place, path, size, more);
    Flown flown;
    if (!statistics.is_null()) flown.summary = statistics["summary"];
    for (int i = 0; i < 3; ++i) {
        auto frame = client::read_png(folder / fmt::format("frames/frame_{:05}.png", i));
        EXPECT_TRUE(frame);
        if (frame) flown.frames.push_back(std::move(*frame));
    }
    return flown;
}

}  // namespace citystream::tests
