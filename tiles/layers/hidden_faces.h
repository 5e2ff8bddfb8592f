// Faces that no camera above the ground can see.
#pragma once

#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Drops the floors of a building: downward triangles of ground surfaces, and downward triangles of unknown surfaces
/// that lie flat at its bottom. Leaves buildings with modelled windows or doors alone, as these may be gaps, and the
/// object alone when nothing else would remain.
void drop_hidden_faces(quadtree::BuildObject& object);

}  // namespace citystream::tiles::layers
