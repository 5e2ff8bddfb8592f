// How many steps a tile's mesh layer has. Each more makes the first step smaller and the sum larger: where points lie
// on a lattice (prism_planes.h) or triangles fold at the coarser step, there is little to leave out and much to add.
#pragma once

#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_wire.h"

namespace citystream::codec::mesh {

/// The layer with the number of steps, 1 to options.most_steps, of which first step and whole layer are least together:
/// some views need the one, some the other. Numbers are tried in turn, until one is no better than the one before.
/// Preconditions as of make_content. Deterministic.
MeshWire encode_best_steps(const MeshTile& tile, const MeshContentOptions& options);

}  // namespace citystream::codec::mesh
