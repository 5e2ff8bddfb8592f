// Counts of durations in log-linear buckets, in the manner of HdrHistogram: every percentile within 0.4 %, whatever the
// range, in fixed memory.
#pragma once

#include <bit>
#include <chrono>
#include <cstdint>
#include <vector>

namespace citystream::client {

/// Values are nanoseconds. Below 128 ns every value has a bucket of its own; above, each power of two is cut into 128
/// buckets. Not thread-safe; merge the histograms of several threads at the end.
class LatencyHistogram {
  public:
    LatencyHistogram();

    /// Negative durations count as 0. O(1).
    void record(std::chrono::nanoseconds value);
    void merge(const LatencyHistogram& other);

    uint64_t count() const { return count_; }
    /// Smallest value that at least `percent` % of the values do not exceed (the middle of its bucket, at most the
    /// maximum); 0 when empty. O(buckets).
    std::chrono::nanoseconds percentile(double percent) const;
    std::chrono::nanoseconds max() const { return std::chrono::nanoseconds(max_); }  ///< exact
    std::chrono::nanoseconds mean() const;

  private:
    static constexpr int kSubBits = 7;
    static constexpr uint64_t kSubCount = uint64_t{1} << kSubBits;
    static size_t bucket_of(uint64_t value);
    static uint64_t middle_of(size_t bucket);

    std::vector<uint64_t> buckets_;
    uint64_t count_ = 0;
    int64_t max_ = 0;
    double sum_ = 0;
};

}  // namespace citystream::client
