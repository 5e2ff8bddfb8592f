// A shaped link: all bytes of one fetcher pass one after the other through a link of fixed rate.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

#include "client/stream/fetcher.h"

namespace citystream::client {

/// The token bucket of a fetcher, as a queue with a known end: reserving bytes tells when the last of them has arrived.
/// Thread-safe. Without a shape everything arrives at once. In any span of time no more bytes pass than the rate allows
/// in that span and kLateness.
class ShapedLink {
  public:
    using Clock = std::chrono::steady_clock;
    /// A sleeper wakes a little late. A link that was busy until this long ago counts as busy still, or it would idle a
    /// little between any two chunks.
    static constexpr Clock::duration kLateness = std::chrono::milliseconds(2);
    explicit ShapedLink(const std::optional<NetworkShape>& shape) : shape_(shape.value_or(NetworkShape{})) {}

    /// When `bytes` that enter the link at `at` have passed it. Calls come in the order of their `at`: after a booking
    /// of the future the link idles until then, whoever comes in between.
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
