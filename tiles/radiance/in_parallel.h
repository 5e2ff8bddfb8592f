// The same work on many things, on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace citystream::tiles::radiance {

/// Calls work(i) once for every i below `count`, in any order, and waits for all of them; begins no further one once
/// work has returned false. `jobs`: threads, 0: one a core. True when all were done. What work writes must belong to i.
inline bool in_parallel(size_t count, uint32_t jobs, const std::function<bool(size_t)>& work) {
    std::atomic<size_t> next = 0;
    std::atomic<bool> stopped = false;
    const auto take_turns = [&] {
        for (size_t i = next++; i < count && !stopped; i = next++) {
            if (!work(i)) stopped = true;
        }
    };
    const size_t threads = jobs != 0 ? jobs : std::max(1U, std::thread::hardware_concurrency());
    {
        std::vector<std::jthread> others;
        for (size_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(take_turns);
        take_turns();
    }
    return !stopped;
}

}  // namespace citystream::tiles::radiance
