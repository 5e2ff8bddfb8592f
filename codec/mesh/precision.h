// How many low bits of a position may be left out: by distance (adaptive precision, Meyer 2012, chapter 3), the same
// for the same place in every buffer, so that no cracks open.
//
// A position is a *word* of B bits a component on the global grid, relative to its buffer's origin. At bit level b the
// top b bits are there and B - b are *dropped*. Buffers have different B but one grid, so what they share is the number
// of dropped bits s: step 2^s grid units (Eq. 3.1).
//
// Everything that a shader repeats is exact in 32-bit integers; shaders/precision_fetch.glsl is the twin.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/precision_layout.h"

namespace citystream::codec::mesh {

/// What is allowed on the screen (section 3.4.1; lengths in one unit of the caller's choice).
struct ScreenError {
    double pixels = 0.5;     ///< allowed error, dp
    double view_pixels = 0;  ///< pixels p across ...
    double near_length = 0;  ///< ... the near plane's length h
    double near_distance = 0;

    /// World length that an error covers at `distance`: dw = dp h z / (p n).
    double movement_at(double distance) const {
        return pixels * near_length * distance / (view_pixels * near_distance);
    }
};

/// Bit level by Eq. 3.1 and 3.3 (with the erratum of 3.5): the least b with step * 2^(full_bits - b) <= dw(distance),
/// within 1..full_bits. A distance that is not positive, or no number, gives full_bits; infinity gives 1.
uint32_t level_at(const ScreenError& error, double distance, double step, uint32_t full_bits);

/// floor(log2(movement)) within 0..most: dropped bits whose step is at most the movement (grid units). 0 for what is
/// below 1 or no number. Exact.
uint32_t dropped_for(double movement, uint32_t most);

/// The rule of one frame, the same for all buffers. A vertex at distance z (grid units) drops
/// min(common_dropped, floor(log2(z / distance_per_unit))) bits.
struct DropRule {
    uint32_t distance_per_unit = 1;  ///< distance at which a step of one grid unit is the allowed error, >= 1
    /// Most bits ever dropped, one number for the city (below 30): what is above them is in every buffer, so that the
    /// distance can be taken from bits that all buffers have.
    uint32_t common_dropped = 0;

    uint32_t dropped_at(uint32_t distance) const;
};

/// How a coordinate is read at s dropped bits. Greatest error, in steps 2^s: kLow below 1, always downwards (P1);
/// kMiddle 1/2; kThirds 2/3, but multiples of 2^s (tile borders, ground, whole metres) are exact.
enum class Reconstruction : uint32_t {
    kLow = PRECISION_READ_LOW,
    kMiddle = PRECISION_READ_MIDDLE,
    kThirds = PRECISION_READ_THIRDS
};

/// Greatest error of a coordinate in steps 2^s: 1, 1/2 or 2/3.
double greatest_error(Reconstruction reading);

/// `off_axis_cosine`: of the angle between the view's axis and its furthest corner. Distances are from the eye and not
/// along the axis, so that turning changes nothing; its square makes up for what perspective stretches there. 1: as
/// printed, exact on the axis. `reading`: the allowed error is the greatest one, so that what is read in the middle
/// drops a bit more than what is read low (for which the rule is the printed one).
DropRule drop_rule(const ScreenError& error, double off_axis_cosine, uint32_t common_dropped,
                   Reconstruction reading = Reconstruction::kLow);

/// At most the Euclidean length of the gaps (each below 2^31), and at least 0.95 of it less 3 * 256. Never falls when a
/// gap grows.
uint32_t distance_bound(const std::array<uint32_t, 3>& gaps);

/// What is added to the origin and the known bits where `dropped` bits are missing.
uint32_t reading_offset(Reconstruction reading, uint32_t dropped);

/// Where a buffer's words lie on the global grid.
struct PrecisionGrid {
    /// Coordinate of word 0. A multiple of 2^common_dropped, less the same number for all buffers (0 but for kThirds).
    GridPoint origin{};
    uint32_t common_dropped = 0;
    Reconstruction reading = Reconstruction::kThirds;
    std::array<uint32_t, 3> bits{};  ///< B of each axis, common_dropped + 1..31

    uint32_t full_bits() const;
    /// Words of a point inside the box that the grid was made for.
    std::array<uint32_t, 3> words_of(const GridPoint& point) const;
    /// Coordinates at s dropped bits; lower bits of the words do not matter.
    GridPoint point_of(const std::array<uint32_t, 3>& words, uint32_t dropped) const;
};

/// The smallest grid for the points. Precondition: magnitudes below 2^30, common_dropped below 30.
PrecisionGrid grid_of(std::span<const GridPoint> points, uint32_t common_dropped, Reconstruction reading);

/// Dropped bits of a box of words [low, high] (a vertex: low == high) seen from a camera. `from_camera`: the grid's
/// origin less the grid cell of the camera (floor), below 2^30 in magnitude as are its sums with words. Only the bits
/// above common_dropped are looked at, and the nearest corner of the cells that they name counts: every vertex of a box
/// drops at least as many bits as the box (P4 with the erratum: no vertex that two buffers share drops different
/// numbers).
uint32_t dropped_in_box(const DropRule& rule, const std::array<int32_t, 3>& from_camera,
                        const std::array<uint32_t, 3>& low, const std::array<uint32_t, 3>& high);

/// What a buffer should drop next, where `resident` bits are dropped now: finer at once, coarser only when it would
/// still be so an eighth nearer, so that a camera that trembles at a threshold changes nothing.
uint32_t settled_dropped(const DropRule& rule, uint32_t resident, const std::array<int32_t, 3>& from_camera,
                         const std::array<uint32_t, 3>& low, const std::array<uint32_t, 3>& high);

}  // namespace citystream::codec::mesh
