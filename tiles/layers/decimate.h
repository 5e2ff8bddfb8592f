// Half-edge-collapse decimation on OpenMesh's mesh and quadrics: no flipped triangles, measured distance, patch by
// patch of equal paint.
#pragma once

#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Collapses vertices while the distance of the collapsed points to the new surface stays within `allowed` metres.
/// Border vertices, vertices on seams between paints and breaks of texture coordinates stay where they are; the rest
/// keeps its texture coordinates (half-edge collapses only). Adds the distance to object.error. Triangles that make the
/// surface non-manifold stay as they are.
void decimate(quadtree::BuildObject& object, double allowed);

}  // namespace citystream::tiles::layers
