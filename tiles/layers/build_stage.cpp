#include "tiles/layers/build_stage.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace citystream::tiles::layers {

Status BuildStage::run(size_t count, const std::function<Status(size_t)>& work) {
    std::atomic<size_t> next = 0;
    const auto take_turns = [&] {
        for (size_t i = next++; i < count && !stopped(); i = next++) finish_one(work(i));
    };
    const uint32_t jobs = options_.jobs != 0 ? options_.jobs : std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (uint32_t i = 1; i < std::min<size_t>(jobs, count); ++i) threads.emplace_back(take_turns);
    take_turns();
    threads.clear();
    return error_ ? Status(*error_) : Status(Done{});
}

bool BuildStage::stopped() {
    const std::lock_guard lock(mutex_);
    if (!error_ && options_.cancel != nullptr && options_.cancel->load()) error_ = Error{"interrupted"};
    return error_.has_value();
}

void BuildStage::finish_one(const Status& status) {
    const std::lock_guard lock(mutex_);
    if (!status && !error_) error_ = status.error();
    if (options_.progress) options_.progress(name_, ++done_, total_);
}

}  // namespace citystream::tiles::layers
