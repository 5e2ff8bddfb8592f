// Coarser versions of a facade map: for distance, so that windows neither cost nor shimmer.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

inline constexpr uint32_t kMostFacadeLevels = 4;
inline constexpr std::array<uint32_t, kMostFacadeLevels - 1> kCoarseTexelsCm = {64, 16, 4};

struct FacadeLevel {
    RunGrid grid;                  ///< of the same size in texels; its breaks are multiples of texel_cm (or the size)
    uint32_t texel_cm = 1;         ///< 1: exact
    float displacement_error = 0;  ///< metres: greatest |D - D of the original| over texels that are open in neither
};

/// Coarse to fine, the exact map last; 1 to kMostFacadeLevels levels of kCoarseTexelsCm and 1 cm. Errors never grow. A
/// coarser level is left out where it would not be much smaller than the next finer one, and where texels of its size
/// are too coarse for relief as shallow as this to be drawn at all.
std::vector<FacadeLevel> make_levels(const RunGrid& grid);

/// The map on texels of `texel_cm` >= 1: each row of texels takes, texel by texel, the label that covers most of it,
/// then each column does. What is thinner than half a texel vanishes, edges move by half a texel at most, and parts
/// that are equal along a wall or from floor to floor stay so where they lie alike in the coarse texels. A border that
/// is nowhere recessed stays so: through a recess that reaches a building's corner one looks past the wall. On its
/// coarsest grid. O(cells) and O(coarse cells).
RunGrid coarsen(const RunGrid& grid, uint32_t texel_cm);

}  // namespace citystream::codec::facade
