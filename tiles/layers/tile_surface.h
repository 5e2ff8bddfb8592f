// What of a tile's content light falls on, and what stands in its way: its triangles and the rectangles of its facades,
// without materials. What can be seen through counts as it is; skirts do not count.
#pragma once

#include <span>
#include <vector>

#include "tiles/quadtree/build_object.h"
#include "tiles/quadtree/spool_file.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::layers {

using Surface = std::vector<radiance::SurfaceTriangle>;

/// Facades count as the rectangles that they displace. Triangles of 1,000 km and more (exact_normal) are left out.
Surface surface_of(std::span<const quadtree::BuildObject> objects);

/// Box of all corners.
quadtree::GridBox box_of(std::span<const radiance::SurfaceTriangle> surface);

/// Appends a surface to a file of surfaces.
Result<quadtree::SpoolRange> append_surface(quadtree::SpoolFile& file,
                                            std::span<const radiance::SurfaceTriangle> surface);
/// Error: the disk, or a range that was not appended.
Result<Surface> read_surface(quadtree::SpoolFile& file, const quadtree::SpoolRange& range);

}  // namespace citystream::tiles::layers
