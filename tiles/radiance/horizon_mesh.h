// The height grid's cells as boxes without bottoms, for rays to meet.
#pragma once

#include <array>
#include <vector>

#include "tiles/radiance/height_grid.h"

namespace citystream::tiles::radiance {

struct HorizonMesh {
    std::vector<GridPoint> points;                   ///< absolute
    std::vector<std::array<uint32_t, 3>> triangles;  ///< either way round
};

/// Tops of the cells low..high that have a height, and sides where a cell is higher than the next one. A side reaches
/// down to the next one's top, or, where nothing is, kHorizonDepth below its own: a ray that comes from inside of a box
/// leaves it through a face, too.
HorizonMesh horizon_mesh(const HeightGrid& heights, HeightCell low, HeightCell high);

inline constexpr int64_t kHorizonDepth = int64_t{4096} << kGridBits;

}  // namespace citystream::tiles::radiance
