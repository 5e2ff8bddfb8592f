// How much of the world one repeat of an image covers, and the size in texels that a level of detail needs of it
// (thesis sections 6.1 and 7.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace citystream::codec::atlas {

/// A corner of a textured polygon: metres, and texture coordinates in repeats (1 is one image).
struct CoverageVertex {
    std::array<double, 3> position{};
    std::array<double, 2> texture{};
};

/// What all polygons that show one image say about it.
struct Coverage {
    double metres_u = 0, metres_v = 0;    ///< largest patch that one repeat maps to, per axis of the image (w_s, h_s)
    double repeats = 0;                   ///< repeats shown by all polygons together (r): their area in the texture
    double repeats_u = 0, repeats_v = 0;  ///< largest span of one polygon's coordinates
    uint64_t polygons = 0;                ///< that count
    uint64_t degenerate = 0;              ///< passed over: no area in space or in the texture, or not finite

    /// An image that no polygon shows needs no chart.
    bool used() const { return polygons > 0; }
};

/// Adds one planar polygon of three or more corners; its mapping is taken from the fan triangle with the largest area
/// in the texture (all are alike where the mapping is affine). Metres per repeat along u are |dP/du|: those of an image
/// that is turned, sheared or mirrored on the wall, too. O(corners).
void add_polygon(Coverage& coverage, std::span<const CoverageVertex> corners);

/// Adds what another part of the city says about the same image.
void add_coverage(Coverage& coverage, const Coverage& other);

struct ChartSize {
    uint32_t width = 1, height = 1;
    bool operator==(const ChartSize&) const = default;
};

/// Size of an image at `metres_per_texel` (> 0): min(image, floor(metres / metres_per_texel)) and at least 1, for each
/// axis on its own; never larger than the image. 1 x 1 when the image is not used.
ChartSize view_size(ChartSize image, const Coverage& coverage, double metres_per_texel);

}  // namespace citystream::codec::atlas
