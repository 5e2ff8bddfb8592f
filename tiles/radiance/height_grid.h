// How high a city is, cell by cell: what stands on the horizon of a tile, beyond the reach within which every triangle
// counts (occluder_scene.h).
//
// Cells are squares of kHeightCellMetres on a lattice of the whole world, so that neighbouring tiles see the same
// horizon. A cell is as high as the highest point of any surface above it: far away a city hides a little too much
// rather than too little. At 128 m, where the horizon begins, a cell is 7 degrees wide.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance {

inline constexpr int64_t kHeightCellMetres = 16;
inline constexpr int64_t kHeightCell = kHeightCellMetres << kGridBits;

/// Cell numbers: cell (x, y) is kHeightCell * x <= grid x < kHeightCell * (x + 1).
struct HeightCell {
    int64_t x = 0, y = 0;
    friend bool operator==(const HeightCell&, const HeightCell&) = default;
};
HeightCell height_cell_of(int64_t grid_x, int64_t grid_y);

class HeightGrid {
  public:
    static constexpr int32_t kNothing = INT32_MIN;

    /// Cells low..high, both included; 4 bytes each. Precondition: low <= high, fewer than 2^31 cells, and heights are
    /// within 2^31 grid units of `base`.
    HeightGrid(HeightCell low, HeightCell high, int64_t base = 0);

    /// Raises the cells that a triangle is above, each to the highest point of the triangle within it (rounded up);
    /// what is outside of the grid is left out. The order of triangles does not matter.
    void add(const SurfaceTriangle& triangle);
    void add(std::span<const SurfaceTriangle> triangles);
    /// Raises one cell to a height, absolute grid units.
    void raise(HeightCell cell, int64_t height);

    /// The cells low..high of it; those outside of it have no height. Precondition: low <= high.
    HeightGrid part(HeightCell low, HeightCell high) const;

    HeightCell low() const { return low_; }
    HeightCell high() const { return high_; }
    /// Absolute grid units; nothing where no surface is, and outside.
    std::optional<int64_t> height(HeightCell cell) const;

  private:
    bool holds(HeightCell cell) const;
    size_t place_of(HeightCell cell) const;

    HeightCell low_, high_;
    int64_t base_;
    std::vector<int32_t> heights_;  ///< row by row, above base_
};

}  // namespace citystream::tiles::radiance
