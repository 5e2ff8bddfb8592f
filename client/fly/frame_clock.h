// Gives the time of each frame of a path: a fixed step offline, the wall clock in realtime mode.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "client/path/camera_path.h"

namespace citystream::client {

class FrameClock {
  public:
    FrameClock(const CameraPath& path, double frames_per_second, bool realtime)
        : begin_(path.samples.front().t),
          duration_(path.duration()),
          frames_per_second_(frames_per_second),
          realtime_(realtime) {}

    /// Seconds of the path. Waits for the next frame's moment in realtime mode, where a frame that took too long drops
    /// the moments that it missed. Nothing when the path is over.
    std::optional<double> next();
    /// Share of the path that is over at a time, 0..1.
    double done(double t) const;

  private:
    using Clock = std::chrono::steady_clock;

    double begin_, duration_, frames_per_second_;
    bool realtime_;
    uint64_t index_ = 0;
    Clock::time_point start_;
};

}  // namespace citystream::client
