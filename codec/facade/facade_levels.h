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
    RunGrid grid;                  ///< of the same size in texels; its breaks lie on the coarse texels (or the size)
    uint32_t texel_cm = 1;         ///< of its coarse texels; 1: exact
    float displacement_error = 0;  ///< metres: greatest |D - D of the original| over texels that are open in neither
};

/// Coarse to fine, the exact map last; 1 to kMostFacadeLevels levels of kCoarseTexelsCm and 1 cm. Errors never grow. A
/// coarser level is left out where it would not be much smaller than the next finer one, and where texels of its size
/// are too coarse for relief as shallow as this to be drawn at all. `texel_metres`: of the map, 0.01 where nothing else
/// is said; 2 mm make a coarse texel of 16 cm 80 texels of the map.
std::vector<FacadeLevel> make_levels(const RunGrid& grid, double texel_metres = 0.01);

/// Texels of a map that a length comes to, at least one.
uint32_t texels_of(double metres, double texel_metres);

/// The map on coarse texels of `texel` >= 1 of its own: each row of texels takes, texel by texel, the label that covers
/// most of it, then each column does. What is thinner than half a texel vanishes, edges move by half a texel at most,
/// and parts that are equal along a wall or from floor to floor stay so where they lie alike in the coarse texels. A
/// border that is nowhere recessed stays so: through a recess that reaches a building's corner one looks past the wall.
/// On its coarsest grid. O(cells) and O(coarse cells).
RunGrid coarsen(const RunGrid& grid, uint32_t texel);

}  // namespace citystream::codec::facade
