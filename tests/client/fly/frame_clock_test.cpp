#include "client/fly/frame_clock.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace citystream::client {
namespace {

CameraPath path_between(double begin, double end) {
    CameraPath path;
    path.samples.resize(2);
    path.samples[0].t = begin;
    path.samples[1].t = end;
    return path;
}

std::vector<double> times_of(FrameClock& clock) {
    std::vector<double> times;
    while (const auto t = clock.next()) times.push_back(*t);
    return times;
}

TEST(FrameClock, OfflineFramesStandAFixedStepApartUntilThePathsEnd) {
    FrameClock clock(path_between(3, 4), 10, false);
    const std::vector<double> times = times_of(clock);
    ASSERT_EQ(times.size(), 11U) << "the last moment has a frame";
    for (size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], 3 + static_cast<double>(i) / 10, 1e-12);
    EXPECT_EQ(clock.done(3), 0);
    EXPECT_NEAR(clock.done(3.5), 0.5, 1e-12);
    EXPECT_EQ(clock.done(9), 1);
}

TEST(FrameClock, AStandingCameraHasOneFrame) {
    for (const bool realtime : {false, true}) {
        FrameClock clock(path_between(5, 5), 10, realtime);
        EXPECT_EQ(times_of(clock), std::vector<double>{5});
        EXPECT_EQ(clock.done(5), 1);
    }
}

TEST(FrameClock, InRealtimeASlowFrameDropsTheMomentsItMissed) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    FrameClock clock(path_between(0, 0.3), 100, true);
    EXPECT_EQ(clock.next(), 0.0);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const auto second = clock.next();
    ASSERT_TRUE(second);
    EXPECT_GE(*second, 0.1);
    EXPECT_GE(std::chrono::duration<double>(Clock::now() - begin).count(), *second) << "not before its moment";
    double last = *second;
    while (const auto t = clock.next()) {
        EXPECT_GT(*t, last);
        last = *t;
    }
    EXPECT_LE(last, 0.3 + 1e-9);
}

}  // namespace
}  // namespace citystream::client
