// What a city shows of its images, found in one pass over all its objects: how much of the world a repeat of each
// covers, and from that the finest size that any tile can ask for (thesis sections 6.1 and 7.1).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/atlas/coverage.h"
#include "codec/result.h"
#include "tiles/quadtree/object_spool.h"

namespace citystream::tiles::layers {

struct ImageUse {
    codec::atlas::Coverage coverage;  ///< by triangles, and by facades whose palettes have it (planar mapping)
    bool on_facades = false;
    bool clamped = false;  ///< some material ends at the image's edges instead of repeating it
    /// Box of all texture coordinates of triangles, repeats.
    std::array<double, 2> lowest = {1e300, 1e300}, highest = {-1e300, -1e300};

    bool used() const { return coverage.polygons + coverage.degenerate > 0; }
    /// Share of the image that can be seen, 0..1; 1 where it repeats or that is not known.
    double shown_share() const;
};

/// Of every image of the catalog. Deterministic; O(triangles), on `jobs` threads (0: all cores). Not read at all when
/// the catalog has no images. Error: the disk.
Result<std::vector<ImageUse>> find_image_uses(quadtree::ObjectSpool& objects, const city::CityCatalog& catalog,
                                              uint32_t jobs);

/// A mip is shown if its texels are at least the wanted ones divided by this: halvings hit no size exactly.
inline constexpr double kFinestShare = 1.5;

/// The size of an image of `width` x `height` texels that no tile exceeds: each axis halved while its texels are finer
/// than tiles whose finest texel is of `texel_metres` show, at most 8192. Never larger than the image; as large where
/// no triangle shows an area of it.
/// Not the thesis's size (7.1, codec::atlas::view_size), which is resampled to that texel exactly: what tiles show are
/// halvings of this image, so that one chart serves all levels and all tiles, and an image that is nearly as fine as
/// wanted keeps its own texels instead of being filtered twice. It is 3/4 to 3/2 of the thesis's size a side.
codec::atlas::ChartSize finest_size(codec::atlas::ChartSize image, const ImageUse& use, double texel_metres);

}  // namespace citystream::tiles::layers
