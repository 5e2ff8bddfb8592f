// The global grid: the one unit of position in tiles, shared by every codec and by the quadtree.
#pragma once

#include <cmath>
#include <cstdint>

namespace citystream {

/// Grid units per metre. A position is an integer multiple of 2^-10 m, in the projected CRS of the city.
inline constexpr int kGridBits = 10;
inline constexpr double kGridUnitsPerMetre = 1 << kGridBits;
inline constexpr double kMetresPerGridUnit = 1.0 / kGridUnitsPerMetre;

/// A point on the global grid (absolute, int64) or relative to a tile.
struct GridPoint {
    int64_t x = 0, y = 0, z = 0;
    friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// Nearest grid coordinate of a coordinate in metres; exact for |metres| < 2^43.
inline int64_t to_grid(double metres) {
    return std::llround(metres * kGridUnitsPerMetre);
}
inline double to_metres(int64_t grid) {
    return static_cast<double>(grid) * kMetresPerGridUnit;
}

}  // namespace citystream
