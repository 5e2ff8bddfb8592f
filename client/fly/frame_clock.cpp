#include "client/fly/frame_clock.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace citystream::client {
namespace {

/// Of seconds and of frames: rounding does not cost a path its last frame.
constexpr double kRounding = 1e-9;

}  // namespace

std::optional<double> FrameClock::next() {
    if (realtime_ && index_ == 0) {
        start_ = Clock::now();
    } else if (realtime_) {
        const double now = std::chrono::duration<double>(Clock::now() - start_).count();
        index_ = std::max(index_, static_cast<uint64_t>(std::ceil(now * frames_per_second_ - kRounding)));
    }
    const double t = static_cast<double>(index_) / frames_per_second_;
    if (t > duration_ + kRounding) return std::nullopt;
    if (realtime_) {
        std::this_thread::sleep_until(start_ +
                                      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(t)));
    }
    ++index_;
    return begin_ + t;
}

double FrameClock::done(double t) const {
    return duration_ > 0 ? std::clamp((t - begin_) / duration_, 0.0, 1.0) : 1.0;
}

}  // namespace citystream::client
