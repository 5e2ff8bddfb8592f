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

}  // namespace
}  // namespace citystream::client
