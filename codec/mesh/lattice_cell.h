// Range quantisation's search (Meyer 2012, section 4.7.2; notes N5): of the four lattice points round a place in the
// parameter domain the one that decodes nearest. A wider search brings no lower maximum.
#pragma once

#include <algorithm>
#include <cstdint>

namespace citystream::codec::mesh {

struct LatticePoint {
    int64_t u = 0, v = 0;
};

/// The corner of the cell [low, low + 1]^2 with the least `farness(point)`; the first of equals in the order (0, 0),
/// (1, 0), (0, 1), (1, 1). Corners outside first..last are moved onto its rim.
template <typename Farness>
LatticePoint nearest_of_cell(LatticePoint low, int64_t first, int64_t last, const Farness& farness) {
    const auto corner = [&](int64_t i) {
        return LatticePoint{std::clamp(low.u + (i & 1), first, last), std::clamp(low.v + (i >> 1), first, last)};
    };
    LatticePoint best = corner(0);
    auto least = farness(best);
    for (int64_t i = 1; i < 4; ++i) {
        const LatticePoint point = corner(i);
        const auto far = farness(point);
        if (!(far < least)) continue;
        best = point;
        least = far;
    }
    return best;
}

}  // namespace citystream::codec::mesh
