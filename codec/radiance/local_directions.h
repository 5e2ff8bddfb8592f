// Local directions of incident light: the centres of m x m cells of equal area on a receiver's hemisphere, and which of
// them is nearest to a direction.
//
// Cells come from the square by Shirley and Chiu's low-distortion map: x = 2a - 1, y = 2b - 1; if |x| > |y|: r = x,
// phi = pi/4 y/x, else r = y, phi = pi/2 - pi/4 x/y; direction (r cos phi sqrt(2 - r^2), r sin phi sqrt(2 - r^2),
// 1 - r^2). Direction j is the centre of column j % m, row j / m. The worst angle to the nearest is 15 degrees for 8 x
// 8 and 3.8 for 32 x 32.
//
// Nearest means the greatest scalar product, in integers; of equals the lowest number. What light a direction stands
// for is its nearest region, not its square cell, hence cosines averaged over these regions (`cell_averages`): taken at
// the centres they make a uniform sky 3 % too bright.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/radiance/source_directions.h"

namespace citystream::codec::radiance {

inline constexpr uint32_t kMostLocalSide = 32;

class LocalDirections {
  public:
    /// `side`: m, 1..kMostLocalSide. O(m^2), about 2 ms for 8 x 8.
    explicit LocalDirections(uint32_t side);

    uint32_t side() const { return side_; }
    uint32_t count() const { return side_ * side_; }
    /// Unit vector times frames.h's kFrameOne, rounded; x along the tangent, z along the normal.
    const GridDirection& direction(uint32_t j) const { return directions_[j]; }
    /// Of a vector of any length, components below 2^31 in magnitude, also from below the plane. O(1).
    uint32_t nearest(const std::array<int64_t, 3>& local) const;
    /// The same by looking at all directions.
    uint32_t nearest_of_all(const std::array<int64_t, 3>& local) const;

  private:
    uint32_t side_;
    std::vector<GridDirection> directions_;
    /// Of each cell of a cube grid around the receiver: which directions may be the nearest to something in it.
    std::vector<uint32_t> candidate_begin_;
    std::vector<uint16_t> candidates_;
};

struct CellAverages {
    std::vector<double> solid_angle;  ///< of the region that is nearest to each direction; they add up to 2 pi
    std::vector<double> cosine;       ///< mean of the cosine to the normal in it; times solid_angle they add up to pi
};

/// Over the upper half of a cube grid of 256 cells across. About 10 ms for 8 x 8.
CellAverages cell_averages(const LocalDirections& directions);

}  // namespace citystream::codec::radiance
