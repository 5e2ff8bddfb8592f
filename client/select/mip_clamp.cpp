#include "client/select/mip_clamp.h"

#include <algorithm>
#include <cmath>

namespace citystream::client {

using tiles::tileset::StepRecord;

namespace {

/// From this mip on there is nothing coarser in any chart.
constexpr double kCoarsest = 16;

float in_range(double mip) {
    return static_cast<float>(std::clamp(mip, 0.0, kCoarsest));
}

}  // namespace

float clamped_mip(double metres_per_texel, double texel) {
    return metres_per_texel > 0 ? in_range(std::log2(texel / metres_per_texel)) : 0;
}

float clamped_mip(const std::vector<StepRecord>& steps, double texel) {
    if (steps.empty() || !(steps.back().error > 0)) return 0;
    const auto error_of = [&](size_t step) { return static_cast<double>(steps[step].error); };
    /// The first step, which holds the coarsest mip, of those with the same error.
    const auto first_like = [&](size_t step) {
        while (step > 0 && error_of(step - 1) == error_of(step)) --step;
        return step;
    };
    size_t good = 0;  // as shortest_prefix has it
    while (good + 1 < steps.size() && error_of(good) > texel) ++good;
    good = first_like(good);
    const auto mip = static_cast<double>(steps.size() - 1 - good);
    const double doublings = std::log2(texel / error_of(good));
    if (good == 0 || doublings <= 0) return in_range(mip + doublings);
    const size_t before = first_like(good - 1);
    return in_range(mip +
                    static_cast<double>(good - before) * doublings / std::log2(error_of(before) / error_of(good)));
}

}  // namespace citystream::client
