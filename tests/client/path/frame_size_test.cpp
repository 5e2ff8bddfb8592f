#include "client/path/frame_size.h"

#include <gtest/gtest.h>

namespace citystream::client {
namespace {

TEST(FrameSize, IsTwoSidesWithinTheirRange) {
    EXPECT_EQ(*parse_frame_size("1280x720"), (FrameSize{1280, 720}));
    EXPECT_EQ(*parse_frame_size("16384x1"), (FrameSize{16384, 1}));
    EXPECT_FALSE(parse_frame_size("8193x10", 8192).ok());
    EXPECT_TRUE(parse_frame_size("8192x10", 8192).ok());
    for (const char* bad : {"", "x", "1280", "1280x", "x720", "0x720", "1280x720x1", "1280x720 ", "1280*720", "20000x1",
                            "-1x5", "+1x5", "4294968576x720"})
        EXPECT_FALSE(parse_frame_size(bad).ok()) << bad;
}

}  // namespace
}  // namespace citystream::client
