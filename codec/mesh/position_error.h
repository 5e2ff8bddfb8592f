// How wrong positions are at a step of a mesh layer, and back: a tile directory has only the errors of its layers'
// steps, and what a step drops (mesh_content.h) follows from them, so that a client knows before any byte is fetched
// which step a view needs.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "codec/mesh/mesh_content.h"

namespace citystream::codec::mesh {

/// Bits between two steps.
inline constexpr uint32_t kMeshStepBits = 3;

/// Metres. How far a point may be from its place on the grid where `dropped` (0..kMeshGridBits) bits are missing and
/// the others are read as kThirds: sqrt(3) (2^dropped - 1 - floor(2^dropped / 3)) grid units.
double position_error(uint32_t dropped);

/// A step's error in a directory, metres: that of the geometry itself (0 for full detail) and that of positions.
float step_error(float finest_error_metres, uint32_t dropped);

/// Low bits that lie far below the geometry's own error: the most whose unit is at most an eighth of it, at most
/// kMeshGridBits. What the last step of a layer drops. Anything that is no positive number gives 0.
uint32_t finest_dropped(float finest_error_metres);

/// Bits that each step drops, from step_error of all steps of a layer whose steps are kMeshStepBits apart and whose
/// last drops finest_dropped of its own error: exact. Entries past the last step repeat it. One step alone says nothing
/// about positions: 0, it is all there is. Any numbers are taken: the result is at most kMeshGridBits and never rises
/// (steps past kMostMeshSteps are not looked at). O(steps).
std::array<uint32_t, kMostMeshSteps> dropped_of_steps(std::span<const float> errors);

}  // namespace citystream::codec::mesh
