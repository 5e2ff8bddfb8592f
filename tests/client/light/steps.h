// Numbers at even distances, for loops over angles, hours and times.
#pragma once

#include <cmath>
#include <vector>

namespace citystream::client {

/// first, first + step, ... up to last, which counts where a step meets it.
inline std::vector<double> steps(double first, double last, double step) {
    const auto count = static_cast<int>(std::floor((last - first) / step + 1e-9)) + 1;
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(first + i * step);
    return values;
}

}  // namespace citystream::client
