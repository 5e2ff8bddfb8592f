// Counters of a running server and their Prometheus text form.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

namespace citystream::server {

/// All calls may come from any thread; counters are independent relaxed atomics, so a reading is not a snapshot of one
/// instant.
class Metrics {
  public:
    /// Index for requests that name no city (pages, unknown names, malformed requests).
    static constexpr size_t kNoCity = ~size_t{0};

    /// What is known of each city when the server starts.
    struct CityLabel {
        std::string name;
        uint64_t archive_bytes = 0;
    };

    explicit Metrics(std::vector<CityLabel> cities);

    /// One finished answer. `seconds`: from the last byte of the request's head to the last byte handed to the kernel.
    void count_request(size_t city, unsigned status, uint64_t body_bytes, uint64_t sent_bytes, double seconds);
    void connection_opened();
    void connection_closed();
    void connection_refused();
    void request_started();
    void request_timed_out();
    void answer_broken_off();

    uint64_t requests() const;
    uint64_t sent_bytes() const;
    uint64_t connections_open() const { return connections_open_.load(std::memory_order_relaxed); }

    /// Prometheus text exposition format 0.0.4.
    std::string text() const;

    static constexpr std::array<double, 15> kLatencyBounds = {
        0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 10};

  private:
    using Counter = std::atomic<uint64_t>;
    struct PerCity {
        CityLabel label;
        std::array<Counter, 5> by_class{};  ///< 1xx .. 5xx
        Counter body_bytes{0};
        Counter partial{0};
        Counter not_modified{0};
    };

    void write_per_city(std::string& out) const;
    void write_connections(std::string& out) const;
    void write_latency(std::string& out) const;

    std::vector<std::unique_ptr<PerCity>> cities_;  ///< the last one counts requests without a city
    std::array<Counter, kLatencyBounds.size() + 1> latency_{};
    Counter latency_microseconds_{0};
    Counter sent_bytes_{0};
    Counter requests_started_{0};
    Counter requests_finished_{0};
    Counter connections_open_{0};
    Counter connections_total_{0};
    Counter connections_refused_{0};
    Counter timeouts_{0};
    Counter broken_off_{0};
    std::time_t started_ = 0;
};

}  // namespace citystream::server
