// How many low bits of positions a view may leave out, and the steps of meshes that follow: the client's side of
// adaptive precision (codec/mesh/precision.h).
//
// One rule for the whole frame, the *position tolerance*: no vertex may be farther than that many pixels from its place
// on the screen. What a vertex is granted follows from the place of its cell (RESIDENT_CELL_BITS) and the camera alone.
// A tile's mesh is taken to the first step that drops no more than its nearest cell is granted, so that every vertex of
// it is granted at least what that step leaves out: what is drawn does not depend on which steps are here, and tiles
// that meet show the same place for the same vertex.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/select/camera.h"
#include "codec/grid.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/precision.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// Of one frame.
struct PositionRule {
    codec::mesh::DropRule drop;       ///< cells of RESIDENT_CELL_BITS; bits are read as kThirds
    std::array<int64_t, 3> camera{};  ///< CameraCell::cell: shaders measure distances from there
    /// Pixels of a metre one metre away at the corners of the picture, where perspective stretches most.
    double pixels_at_a_metre = 0;

    /// Pixels that positions read with `dropped` bits missing may be off, at `distance` metres anywhere in the picture.
    double error_pixels(uint32_t dropped, double distance) const;
};

/// `pixels`: the position tolerance. 0 grants nothing.
PositionRule position_rule(const Camera& camera, double pixels);

/// Bits that every vertex in the bounds is granted at least. `origin`: Manifest::origin. O(1).
uint32_t granted_in(const PositionRule& rule, const tiles::tileset::Bounds& bounds, const GridPoint& origin);

/// Bits that each step of a mesh layer drops, from the errors in its step table; 0 where it has one step.
std::array<uint32_t, codec::mesh::kMostMeshSteps> dropped_bits(const std::vector<tiles::tileset::StepRecord>& steps);

/// Number of steps, at least 1: the fewest whose last drops at most `granted` bits, else all `usable` ones.
/// Precondition: usable <= steps.size(); 0 gives 0.
uint8_t mesh_prefix(const std::vector<tiles::tileset::StepRecord>& steps, uint32_t usable, uint32_t granted);

/// Pixels that vertices between `nearest` and `farthest` metres away may be off when each drops what it is granted and
/// at least `least_dropped` bits. At most the tolerance where all are granted that many.
double greatest_position_error(const PositionRule& rule, uint32_t least_dropped, double nearest, double farthest);

}  // namespace citystream::client
