// Timing of peers against each other: every candidate runs in every repetition, so that what disturbs the machine
// disturbs all of them, and figures are ratios within one repetition.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace citystream::bench {

struct Spread {
    double min = 0, median = 0, max = 0;
};

/// Spread of values in any order; zeros of none. The median of an even number is the mean of the two in the middle.
Spread spread_of(std::vector<double> values);

/// Seconds of each candidate in each repetition: result[candidate][repetition]. A candidate that takes less than
/// `least_seconds` is called often enough to reach it, and its seconds are those of one call.
std::vector<std::vector<double>> time_in_turn(std::span<const std::function<void()>> candidates, int repetitions,
                                              double least_seconds = 0.01);

/// Seconds of one call.
double seconds_of(const std::function<void()>& work);
/// Of this thread's processor time: what takes one thread and takes turns with other programs.
double processor_seconds_of(const std::function<void()>& work);

/// Spread of a[i] / b[i].
Spread ratio_of(std::span<const double> a, std::span<const double> b);

/// Keeps a result alive, so that the compiler cannot drop the work that made it.
template <typename T>
inline void keep(const T& value) {
    asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace citystream::bench
