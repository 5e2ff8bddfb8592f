// The height grid of a whole city (height_grid.h), in blocks: memory goes by the ground that is covered, not by the
// city's extent.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "tiles/radiance/height_grid.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance {

/// Cells on a side of a block: 1,024 m.
inline constexpr int64_t kHeightBlockCells = 64;

class CityHeights {
  public:
    /// `base`: as that of HeightGrid, of all that will be added.
    explicit CityHeights(int64_t base) : base_(base) {}

    /// As HeightGrid::add. The order of calls does not matter; they may come from many threads. A level triangle that
    /// covers a block takes no cells there. O(cells under the triangles).
    void add(std::span<const SurfaceTriangle> triangles);

    /// The cells low..high. Not while add is running. Precondition: low <= high.
    HeightGrid part(HeightCell low, HeightCell high) const;

    /// That it holds.
    uint64_t bytes() const;

  private:
    struct Block {
        int32_t level = HeightGrid::kNothing;  ///< of level ground under all of it, above base_
        std::unique_ptr<HeightGrid> cells;
    };
    static void copy(const Block& block, int64_t base, HeightCell first, HeightGrid& to);
    void add(const SurfaceTriangle& triangle);
    void add_to_block(HeightCell block, const SurfaceTriangle& triangle, bool level);

    int64_t base_;
    std::mutex mutex_;
    std::map<std::pair<int64_t, int64_t>, Block> blocks_;  // by y, x
};

}  // namespace citystream::tiles::radiance
