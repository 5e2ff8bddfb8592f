// The box filter that makes mips: halves a side, rounding down; odd sides take three taps weighted by overlap.
#pragma once

#include <cstdint>

namespace citystream::codec::atlas {

/// One output texel's taps along one axis: texels 2i, 2i + 1, 2i + 2 of the finer mip, weights adding up to `total`.
struct BoxTaps {
    uint32_t weight[3];
    uint32_t total;
};

inline BoxTaps box_taps(uint32_t i, uint32_t fine_side) {
    if (fine_side == 1) return {{1, 0, 0}, 1};
    if (fine_side % 2 == 0) return {{1, 1, 0}, 2};
    const uint32_t half = fine_side / 2;
    return {{half - i, half, i + 1}, fine_side};
}

/// Calls visit(i, j, weight) for the taps 2x + i, 2y + j that count.
template <typename Visit>
void for_each_tap(const BoxTaps& across, const BoxTaps& up, Visit visit) {
    for (uint32_t j = 0; j < 3; ++j) {
        for (uint32_t i = 0; i < 3; ++i) {
            const uint64_t weight = uint64_t{across.weight[i]} * up.weight[j];
            if (weight != 0) visit(i, j, weight);
        }
    }
}

}  // namespace citystream::codec::atlas
