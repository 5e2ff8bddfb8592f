// How far two facade maps of one size are apart.
#pragma once

#include <cstdint>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

struct GridDifference {
    int32_t displacement_mm = 0;  ///< greatest |D of a - D of b| over texels that are open in neither
    bool materials = false;       ///< some texel that is open in neither has another material
    bool openings = false;        ///< some texel is open in one only
};

/// Compares texel by texel, run by run. Programming error: grids of different size, or not valid.
/// O((columns of a + columns of b) x (rows of a + rows of b)).
GridDifference difference(const RunGrid& a, const RunGrid& b);

}  // namespace citystream::codec::facade
