// Meshes on the wire: one range coded walk over the surface that carries triangles and places together, and further
// steps of lower bits. Lossless for any list of triangles on the grid (grid_mesh.h says what "the same mesh" is): open,
// of many pieces, not manifold, turned against each other, repeated, with equal corners. Points at one place become
// one; points that no triangle uses are dropped; the order of triangles is that of the walk.
//
// Vertical walls with flat tops (prisms.h) are coded apart as rings and heights wherever that is shorter.
//
// Step 0 holds all triangles and each coordinate shifted right by dropped[0]; step s the dropped[s - 1] - dropped[s]
// bits below. Coordinates are cut on the global grid (floor(coordinate / 2^dropped)), so that equal points of two
// meshes stay equal at equal steps. One step is the smallest; GEOMETRY_FORMAT.md has the bytes, surface_walk.h,
// point_coder.h and point_refinement.h have the models.
//
// Time: about 2 us a triangle to decode, twice that to encode, and a third of it for prisms; encoding sorts the edges,
// O(n log n). Memory: some hundred bytes a triangle and about 2.5 MB of models. Bytes depend on the mesh alone.
//
// Untrusted bytes: decode_geometry checks every index, coordinate and count, stops at the end of the bytes or at the
// limits and never allocates by a number that it read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/grid_mesh.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct GeometrySteps {
    std::vector<std::vector<std::byte>> steps;
    double prism_bits = 0;     ///< of step 0, how many are prisms
    double position_bits = 0;  ///< of all steps, how many say where points are, prisms apart; the rest is topology
};

/// What the reader is ready to make room for.
struct GeometryLimits {
    uint32_t points = 1u << 26, triangles = 1u << 27;
};

/// Bits that a step may drop at most, and the most steps.
inline constexpr uint32_t kMostDroppedBits = 29, kMostGeometrySteps = 8;

/// Preconditions: indices below points.size(), coordinates below 2^30 in magnitude, 1..kMostGeometrySteps entries of
/// dropped, strictly decreasing from at most kMostDroppedBits; lossless if the last is 0.
GeometrySteps encode_geometry(const GridMesh& mesh, std::span<const uint32_t> dropped);

/// The mesh of the first steps.size() >= 1 steps, with the bits that are missing 0.
Result<GridMesh> decode_geometry(std::span<const std::span<const std::byte>> steps, const GeometryLimits& limits = {});

}  // namespace citystream::codec::mesh
