#include "client/load/latency_histogram.h"

#include <algorithm>
#include <cmath>

namespace citystream::client {

LatencyHistogram::LatencyHistogram() : buckets_(bucket_of(~uint64_t{0} >> 1) + 1, 0) {}

size_t LatencyHistogram::bucket_of(uint64_t value) {
    if (value < kSubCount) return value;
    const int shift = static_cast<int>(std::bit_width(value)) - (kSubBits + 1);
    return static_cast<size_t>(shift + 1) * kSubCount + ((value >> shift) - kSubCount);
}

uint64_t LatencyHistogram::middle_of(size_t bucket) {
    if (bucket < kSubCount) return bucket;
    const uint64_t shift = bucket / kSubCount - 1;
    const uint64_t low = (kSubCount + bucket % kSubCount) << shift;
    return low + ((uint64_t{1} << shift) >> 1);
}

void LatencyHistogram::record(std::chrono::nanoseconds value) {
    const int64_t nanoseconds = std::max<int64_t>(value.count(), 0);
    ++buckets_[bucket_of(static_cast<uint64_t>(nanoseconds))];
    ++count_;
    max_ = std::max(max_, nanoseconds);
    sum_ += static_cast<double>(nanoseconds);
}

void LatencyHistogram::merge(const LatencyHistogram& other) {
    for (size_t i = 0; i < buckets_.size(); ++i) buckets_[i] += other.buckets_[i];
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
    sum_ += other.sum_;
}

std::chrono::nanoseconds LatencyHistogram::percentile(double percent) const {
    if (count_ == 0) return {};
    const double exact = std::ceil(std::clamp(percent, 0.0, 100.0) / 100 * static_cast<double>(count_));
    const uint64_t rank = std::clamp<uint64_t>(static_cast<uint64_t>(exact), 1, count_);
    if (rank == count_) return max();
    uint64_t seen = 0;
    for (size_t i = 0; i < buckets_.size(); ++i) {
        seen += buckets_[i];
        if (seen >= rank) return std::chrono::nanoseconds(std::min(static_cast<int64_t>(middle_of(i)), max_));
    }
    return max();
}

std::chrono::nanoseconds LatencyHistogram::mean() const {
    if (count_ == 0) return {};
    return std::chrono::nanoseconds(std::llround(sum_ / static_cast<double>(count_)));
}

}  // namespace citystream::client
