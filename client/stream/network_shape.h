// A shaped link: all bytes of one fetcher pass one after the other through a link of fixed rate.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

#include "client/stream/fetcher.h"

namespace citystream::client {

/// The token bucket of a fetcher, as a queue with a known end: reserving bytes tells when the last of them has arrived.
/// Thread-safe. Without a shape everything arrives at once.
class ShapedLink {
  public:
    using Clock = std::chrono::steady_clock;
    explicit ShapedLink(const std::optional<NetworkShape>& shape) : shape_(shape.value_or(NetworkShape{})) {}

    /// When `bytes` that enter the link at `at` have passed it.
    Clock::time_point reserve(uint64_t bytes, Clock::time_point at);
    /// The way in one direction.
    Clock::duration half_round_trip() const;
    bool shaped() const { return shape_.bits_per_second > 0 || shape_.round_trip_seconds > 0; }

  private:
    NetworkShape shape_;
    std::mutex mutex_;
    Clock::time_point free_at_{};
};

}  // namespace citystream::client
