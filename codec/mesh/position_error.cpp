#include "codec/mesh/position_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "codec/grid.h"

namespace citystream::codec::mesh {

double position_error(uint32_t dropped) {
    assert(dropped <= kMeshGridBits);
    const uint32_t step = uint32_t{1} << dropped;
    return std::numbers::sqrt3 * (step - 1 - step / 3) * kMetresPerGridUnit;
}

float step_error(float finest_error_metres, uint32_t dropped) {
    return static_cast<float>(static_cast<double>(finest_error_metres) + position_error(dropped));
}

uint32_t finest_dropped(float finest_error_metres) {
    const double units = static_cast<double>(finest_error_metres) / 8 * kGridUnitsPerMetre;
    uint32_t dropped = 0;
    while (dropped < kMeshGridBits && std::ldexp(1.0, static_cast<int>(dropped) + 1) <= units) ++dropped;
    return dropped;
}

std::array<uint32_t, kMostMeshSteps> dropped_of_steps(std::span<const float> errors) {
    std::array<uint32_t, kMostMeshSteps> dropped{};
    const size_t steps = std::min<size_t>(errors.size(), kMostMeshSteps);
    if (steps < 2) return dropped;
    // The geometry's own error falls out of the difference, which grows by at least 1.6 with every bit.
    const uint32_t span = kMeshStepBits * static_cast<uint32_t>(steps - 1);
    const double difference = static_cast<double>(errors[0]) - static_cast<double>(errors[steps - 1]);
    uint32_t finest = 0;
    const auto difference_of = [&](uint32_t bits) { return position_error(bits + span) - position_error(bits); };
    while (finest + span < kMeshGridBits && difference > (difference_of(finest) + difference_of(finest + 1)) / 2) {
        ++finest;
    }
    for (size_t s = 0; s < dropped.size(); ++s) {
        dropped[s] = finest + kMeshStepBits * static_cast<uint32_t>(steps - 1 - std::min(s, steps - 1));
    }
    return dropped;
}

}  // namespace citystream::codec::mesh
