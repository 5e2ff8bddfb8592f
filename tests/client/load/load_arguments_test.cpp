#include "client/load/load_arguments.h"

#include <gtest/gtest.h>

namespace citystream::client {
namespace {

TEST(LoadArguments, ReadDurations) {
    EXPECT_DOUBLE_EQ(*parse_load_duration("30s"), 30);
    EXPECT_DOUBLE_EQ(*parse_load_duration("250ms"), 0.25);
    EXPECT_DOUBLE_EQ(*parse_load_duration("1.5"), 1.5);
    EXPECT_DOUBLE_EQ(*parse_load_duration("2m"), 120);
    for (const char* bad : {"", "s", "0", "-1s", "inf", "nan", "30 s", "25h", "1d"})
        EXPECT_FALSE(parse_load_duration(bad).ok()) << bad;
}

TEST(LoadArguments, ReadAmountsOfMemory) {
    EXPECT_EQ(*parse_load_bytes("512MiB"), 512u << 20);
    EXPECT_EQ(*parse_load_bytes("1.5KiB"), 1536u);
    EXPECT_EQ(*parse_load_bytes("2MB"), 2'000'000u);
    EXPECT_EQ(*parse_load_bytes("77"), 77u);
    for (const char* bad : {"", "MiB", "0", "-1MiB", "1TiB", "1 MiB", "1e300", "nan"})
        EXPECT_FALSE(parse_load_bytes(bad).ok()) << bad;
}

}  // namespace
}  // namespace citystream::client
