// A receiver's local frame: which way its surface looks, and how its local directions are turned.
//
// All of it is in integers, so that which local direction is nearest to a world direction (local_directions.h) is the
// same for every reader: a *frame code* of 32 bits stands for three axes in units of 1 / kFrameOne.
//
// Code: octahedral normal of 12 + 12 bits (codec/mesh/octahedral.h; the six axes are exact) | turn << 24 (7 bits) |
// mirrored << 31. Turn t is the tangent's angle about the normal, in 128ths of a full turn from the horizontal
// (-n_y, n_x, 0), or from +x where the normal is vertical. Any code is a frame.
//
// A tile whose buildings do not follow the world's axes has frames that all differ, which costs twice the bytes and
// sums: so a tile may be turned about z by a *yaw bucket*, and the light with it (source_light.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "codec/radiance/source_directions.h"

namespace citystream::codec::radiance {

inline constexpr int32_t kFrameOne = 1 << 14;
inline constexpr uint32_t kFrameNormalBits = 12;  ///< a parameter
inline constexpr uint32_t kFrameTurns = 128;      ///< in a full turn

/// Rows x (tangent), y, z (normal): orthonormal up to rounding, right-handed unless mirrored.
struct Frame {
    std::array<GridDirection, 3> axes;

    /// The direction's components along the axes, times kFrameOne: exact for components below 2^15 in magnitude.
    std::array<int64_t, 3> to_local(const GridDirection& world) const;
    /// Whether a direction is above the surface's plane.
    bool sees(const GridDirection& world) const;
};

/// Nearest code. A normal that is zero or not finite is +z; a tangent that is zero, not finite or along the normal is
/// turn 0. The tangent need not be perpendicular to the normal.
uint32_t pack_frame(const std::array<double, 3>& normal, const std::array<double, 3>& tangent, bool mirrored = false);
/// Turn 0.
uint32_t pack_frame(const std::array<double, 3>& normal);
Frame unpack_frame(uint32_t code);

/// Buckets of a quarter turn: more would be the same for buildings with right angles.
inline constexpr uint32_t kYawBuckets = 256;
/// Radians, counter-clockwise seen from above.
double yaw_angle(uint32_t bucket);
/// The bucket by which most of the horizontal edges (x, y; each counts by its length) come to follow the axes once they
/// are turned back by its angle; the lowest of equals, 0 without edges.
uint32_t common_yaw(std::span<const std::array<double, 2>> edges);
/// A horizontal turn of a direction by an angle.
std::array<double, 3> turned(const std::array<double, 3>& direction, double angle);

}  // namespace citystream::codec::radiance
