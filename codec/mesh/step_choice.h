// How many steps a tile's mesh layer has. Each more makes the first step smaller and the sum larger: where points lie
// on a lattice (prism_planes.h) or triangles fold at the coarser step, there is little to leave out and much to add.
#pragma once

#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_wire.h"

namespace citystream::codec::mesh {

/// How often a view needs a layer whole, to once that its first step is enough. Bytes of positions over those of one
/// step at worst, drone flights over Chiyoda and a generated city, vertices off by 1/32 of the tolerance (by all of
/// it): 1: 1.11 (1.05); 2: 1.04 (1.00); 4: 1.02 (0.97); 6: 1.01 (0.97).
inline constexpr size_t kWholeToFirst = 4;

/// The layer with the number of steps, 1 to options.most_steps, of which first step and kWholeToFirst times the whole
/// are least together: so the whole is at most 1 / kWholeToFirst larger than in one step. Numbers are tried in turn,
/// until one is no better than the one before. Preconditions as of make_content. Deterministic.
MeshWire encode_best_steps(const MeshTile& tile, const MeshContentOptions& options);

}  // namespace citystream::codec::mesh
