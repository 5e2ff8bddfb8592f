// The patch map: the resident form of facades that are floors of bays of windows. Bands hold stripes, stripes hold one
// label or a patch, and what is equal is stored once (patch_structure.h). Random access takes about 8 loads, and rays
// march from patch cell to patch cell (shaders/facade_step_patch.glsl): no box matrix is needed. After the measurements
// of the project's notes on facade maps; words in patch_layout.h and FORMAT.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Exact. The smaller of the two orientations. Fails (the quotient is smaller then) on more than 65,535 different
/// labels and on grids so irregular that a field of the words overflows. Deterministic. Time: patch_search.h.
Result<std::vector<uint32_t>> encode_patch_map(const RunGrid& grid);

/// Whether the words are exactly those of a structure that encode_patch_map could have written: all offsets lie inside,
/// breaks rise, greatest displacements are right. For untrusted bytes.
Status check_patch_map(std::span<const uint32_t> words);

/// Checks and decodes to the coarsest grid. Allocates at most 4 bytes a texel.
Result<RunGrid> decode_patch_map(std::span<const uint32_t> words);

}  // namespace citystream::codec::facade
