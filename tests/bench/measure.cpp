#include "tests/bench/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

namespace citystream::bench {
namespace {

double seconds_of(const std::function<void()>& work, int calls) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i) work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / calls;
}

}  // namespace

double seconds_of(const std::function<void()>& work) {
    return seconds_of(work, 1);
}

double processor_seconds_of(const std::function<void()>& work) {
    const auto now = [] {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    };
    const double begin = now();
    work();
    return now() - begin;
}

Spread spread_of(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const size_t middle = values.size() / 2;
    const double median = values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
    return {values.front(), median, values.back()};
}

std::vector<std::vector<double>> time_in_turn(std::span<const std::function<void()>> candidates, int repetitions,
                                              double least_seconds) {
    std::vector<int> calls;
    for (const auto& work : candidates) {  // the first call also warms caches
        const double once = std::max(seconds_of(work, 1), 1e-9);
        calls.push_back(std::max(1, static_cast<int>(std::ceil(std::min(least_seconds / once, 1e6)))));
    }
    std::vector<std::vector<double>> seconds(candidates.size());
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        for (size_t i = 0; i < candidates.size(); ++i) seconds[i].push_back(seconds_of(candidates[i], calls[i]));
    }
    return seconds;
}

Spread ratio_of(std::span<const double> a, std::span<const double> b) {
    std::vector<double> ratios;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.push_back(a[i] / b[i]);
    return spread_of(std::move(ratios));
}

}  // namespace citystream::bench
