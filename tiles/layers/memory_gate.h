// Keeps what many threads hold at a time below a budget: each announces its bytes and waits until they fit. One may
// always go on, so that work larger than the budget is done alone rather than never. Thread-safe.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace citystream::tiles::layers {

class MemoryGate {
  public:
    explicit MemoryGate(uint64_t budget) : budget_(budget) {}
    void enter(uint64_t bytes) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return used_ == 0 || used_ + bytes <= budget_; });
        used_ += bytes;
        peak_ = std::max(peak_, used_);
    }
    void leave(uint64_t bytes) {
        const std::lock_guard lock(mutex_);
        used_ -= bytes;
        changed_.notify_all();
    }
    /// The most that was announced at a time.
    uint64_t peak() const {
        const std::lock_guard lock(mutex_);
        return peak_;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    uint64_t budget_, used_ = 0, peak_ = 0;
};

}  // namespace citystream::tiles::layers
