// Light from far away by direction: a picture of the whole sphere in latitude and longitude, linear radiance.
//
// Axes are the world's: x east, y north, z up. Row 0 is at the top of the picture and ends at the zenith, the last row
// at the nadir. Columns go clockwise seen from above, as a panorama is seen from within: the centre of the picture is
// north, a quarter of its width to the right of it east. A *yaw* turns what is seen clockwise about the vertical, by
// radians: north comes to lie in the east after a quarter turn.
//
// Texels are areas: all sums over a map weight a texel by its exact solid angle
// (2 pi / width) (cos theta_top - cos theta_bottom).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/source_light.h"
#include "codec/vector.h"

namespace citystream::client {

using codec::radiance::Rgb;
/// Sums of light: radiance times solid angle, linear Rec. 709.
using LightSum = std::array<double, 3>;
using Direction = codec::Vector;
using codec::dot;

/// Greatest radiance of a texel: far above any light, and sums of it stay finite.
inline constexpr float kGreatestRadiance = 1e9F;

/// Rec. 709.
template <typename Colour>
double luminance(const Colour& colour) {
    return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

/// Radians between two unit vectors, exact for small angles, too.
double angle_between(const Direction& a, const Direction& b);
/// Turned clockwise seen from above.
Direction turned_clockwise(const Direction& direction, double yaw);

struct EnvironmentMap {
    uint32_t width = 0, height = 0;  ///< at least 1 each
    std::vector<Rgb> texels;         ///< width * height, finite, 0..kGreatestRadiance

    /// The radiance that comes from a direction of any length but 0: bilinear, across the seam and the poles. `yaw`: of
    /// the map.
    Rgb radiance(const Direction& from, double yaw = 0) const;
};

/// How many texels, from the first, are seen above the horizon, in part at least.
inline size_t texels_above_horizon(const EnvironmentMap& map) {
    return size_t{(map.height + 1) / 2} * map.width;
}

/// Unit vector to a place of the picture: columns 0..width, rows 0..height, texels' centres at halves.
Direction map_direction(uint32_t width, uint32_t height, double column, double row);
/// Steradians of each texel of a row.
double map_solid_angle(uint32_t width, uint32_t height, uint32_t row);

/// Sum of radiance times solid angle over all directions.
LightSum map_energy(const EnvironmentMap& map);
LightSum map_energy(std::span<const Rgb> texels, uint32_t width, uint32_t height);

/// Makes a map of another size from rows as they come: each texel is the mean over its area, so that the energy stays.
class MapReduction {
  public:
    /// From `width` x `height` to at most that many columns and rows.
    MapReduction(uint32_t width, uint32_t height, uint32_t to_width, uint32_t to_height);
    /// The next row from the top. O(width).
    void add_row(std::span<const Rgb> row);
    /// After the last row.
    EnvironmentMap take();

  private:
    uint32_t width_, height_, row_ = 0;
    EnvironmentMap map_;
    std::vector<LightSum> sums_;  ///< radiance times solid angle, of each texel of the result
    std::vector<LightSum> row_means_;
};

/// The map with at most `greatest_width` columns and half as many rows; itself where it is no larger.
EnvironmentMap reduced(const EnvironmentMap& map, uint32_t greatest_width);

}  // namespace citystream::client
