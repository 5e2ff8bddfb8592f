#include "client/fly/frame_output.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "client/render/frame_file.h"
#include "tests/temporary_folder.h"

namespace citystream::client {
namespace {

using tests::TemporaryFolder;

FrameImage grey(uint8_t value) {
    return {8, 4, std::vector<uint8_t>(size_t{4} * 8 * 4, value)};
}

TEST(FrameOutput, KeepsTheFramesInTheirOrder) {
    const TemporaryFolder folder;
    const std::string frames = folder / "made/frames";
    auto output = FrameOutput::open(frames, "", {8, 4}, 10);
    ASSERT_TRUE(output) << output.error().text();
    constexpr uint8_t kFrames = 9;
    for (uint8_t i = 0; i < kFrames; ++i) ASSERT_TRUE((*output)->add(grey(static_cast<uint8_t>(20 * i))));
    ASSERT_TRUE((*output)->finish());
    for (uint8_t i = 0; i < kFrames; ++i) {
        const auto read = read_png(frames + "/frame_0000" + std::to_string(i) + ".png");
        ASSERT_TRUE(read) << read.error().text();
        EXPECT_EQ(read->rgba[0], 20 * i);
    }
    EXPECT_FALSE(std::filesystem::exists(frames + "/frame_00009.png"));
}

TEST(FrameOutput, WhatCannotBeWrittenEndsItWithoutWaiting) {
    const TemporaryFolder folder;
    const std::string frames = folder / "frames";
    auto output = FrameOutput::open(frames, "", {8, 4}, 10);
    ASSERT_TRUE(output);
    // A folder where a frame's file should be.
    std::filesystem::create_directories(frames + "/frame_00002.png");
    Status added = Done{};
    for (int i = 0; i < 50 && added; ++i) added = (*output)->add(grey(1));
    const Status finished = (*output)->finish();
    ASSERT_FALSE(finished);
    EXPECT_NE(finished.error().text().find("frame_00002.png"), std::string::npos) << finished.error().text();
    EXPECT_FALSE(added) << "whoever draws hears of it";
}

TEST(FrameOutput, SaysWhichFolderCannotBeMade) {
    const TemporaryFolder folder;
    std::ofstream(folder / "plain") << "a file";
    const auto output = FrameOutput::open(folder / "plain/frames", "", {8, 4}, 10);
    ASSERT_FALSE(output);
    EXPECT_NE(output.error().text().find("plain/frames"), std::string::npos) << output.error().text();
}

}  // namespace
}  // namespace citystream::client
