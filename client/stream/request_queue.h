// The meeting point of the thread that asks and the threads that fetch: requests wait here by priority, results wait
// here to be polled.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "client/stream/fetcher.h"

namespace citystream::client {

/// Thread-safe. Every submitted request yields exactly one result; its bytes are dropped when it was cancelled
/// meanwhile.
class RequestQueue {
  public:
    // The asking side.
    void submit(FetchRequest request);
    void cancel(uint64_t id);
    std::vector<FetchResult> poll();
    std::vector<FetchResult> wait(std::chrono::milliseconds timeout);
    size_t pending() const;
    FetcherStatistics statistics() const;

    // The fetching side.
    /// The waiting request of highest priority (first submitted among equals) and marks it under way.
    std::optional<FetchRequest> take();
    /// Like take(), but sleeps until there is one, until `until`, or until close().
    std::optional<FetchRequest> take_wait(std::chrono::steady_clock::time_point until);
    bool is_cancelled(uint64_t id) const;
    void deliver(FetchResult result);
    void count_retry();
    void count_bytes(uint64_t header, uint64_t body);
    void close();
    bool closed() const;

  private:
    struct Order {
        double priority;
        uint64_t serial;
        bool operator<(const Order& other) const {
            return priority != other.priority ? priority > other.priority : serial < other.serial;
        }
    };
    std::optional<FetchRequest> take_locked();
    void push_result(FetchResult result);

    mutable std::mutex mutex_;
    std::condition_variable results_arrived_, requests_arrived_;
    std::map<Order, FetchRequest> waiting_;
    std::map<uint64_t, Order> order_of_;  ///< of waiting requests
    std::map<uint64_t, bool> under_way_;  ///< id -> cancelled
    std::vector<FetchResult> results_;
    FetcherStatistics statistics_;
    uint64_t next_serial_ = 0;
    bool closed_ = false;
};

}  // namespace citystream::client
