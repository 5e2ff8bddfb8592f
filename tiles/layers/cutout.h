// Coarse forms of what is cut out by alpha (foliage, fences, railings): fewer of its own faces, enlarged so that they
// cover as much of what is behind as all of them did. A block in their place would close what can be seen through.
// Stochastic simplification of aggregate detail (Cook et al. 2007), with measured error and without chance.
#pragma once

#include <optional>

#include "tiles/layers/image_cache.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Whether a quarter of an object's surface or more is holes in its pictures. Never of objects with facades.
bool see_through(const quadtree::BuildObject& object, ImageCache& images);

/// The fewest faces with holes (doubling from two) that, enlarged within the object's height, cover as much of its
/// bounds along the three axes to a tenth, and stay within `allowed` metres of it, measured; the distance is added to
/// the error it has. A face: triangles of one paint that meet in corners of equal texture coordinates. The share of
/// holes is that of the whole image. Nothing when no fewer triangles do. O(faces * kept + triangles * triangles kept).
std::optional<quadtree::BuildObject> thin_faces(const quadtree::BuildObject& object, double allowed,
                                                ImageCache& images);

}  // namespace citystream::tiles::layers
