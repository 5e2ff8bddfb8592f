// The smallest bin of any whole sides that a set of rectangles can be packed into. For this folder only
// (rectangle_packing_atlas.h is what others call).
#pragma once

#include <optional>
#include <span>

#include "codec/atlas/rectangle_packing_stretch.h"

namespace citystream::codec::atlas {

struct TightPacking {
    RectangleSize bin;
    Packing packing;  ///< complete
};

/// Tries a few widths about the square root of the total area and, for each, the least height that a packer manages;
/// keeps the smallest area. None: not all fit `largest`. Some tens of packings.
std::optional<TightPacking> pack_tight(std::span<const RectangleSize> sizes, RectangleSize largest, PackEffort effort);

}  // namespace citystream::codec::atlas
