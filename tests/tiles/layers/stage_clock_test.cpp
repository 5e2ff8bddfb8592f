#include "tiles/layers/stage_clock.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace citystream::tiles::layers {
namespace {

TEST(StageClock, GivesEachStageTheTimeSinceTheOneBefore) {
    StageClock clock;
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    clock.lap("asleep");
    volatile uint64_t sum = 0;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(30)) sum = sum + 1;
    clock.lap("busy");
    clock.lap("nothing");
    const auto& times = clock.times();
    ASSERT_EQ(times.size(), 3u);
    EXPECT_EQ(times[0].stage, "asleep");
    EXPECT_GE(times[0].seconds, 0.03);
    EXPECT_LT(times[0].processor_seconds, 0.02) << "sleeping takes no processor";
    EXPECT_EQ(times[1].stage, "busy");
    EXPECT_GE(times[1].seconds, 0.03);
    EXPECT_GT(times[1].processor_seconds, times[0].processor_seconds);
    EXPECT_LT(times[2].seconds, times[1].seconds);
}

}  // namespace
}  // namespace citystream::tiles::layers
