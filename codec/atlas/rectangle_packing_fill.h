// Leaf fill: gives the unused space of a layout made of straight cuts to the rectangles that lie beside it.
//
// Source: "Space-Optimized Texture Atlases" 7.3.3, Algorithm 5. As printed it joins an empty leaf only with a sibling
// that is a leaf and so cannot reach the 100 % that the paper states; as corrected in the notes, the whole subtree
// beside an empty leaf is scaled over it and its cuts are placed anew, in whole numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/rectangle_packing.h"

namespace citystream::codec::atlas {

enum class FillMode : uint8_t {
    kNone,
    kSiblingLeaves,  ///< Algorithm 5 as its text reads: an empty leaf beside a leaf that is not empty
    kSubtrees,       ///< empty leaves are dropped and every cut is placed anew
    kInPlace,        ///< every rectangle grows where it lies, into what is empty beside it; works for skylines, too
};

/// How far a rectangle may grow. least: the size that the layout was made for. wanted_most: up to here growth is of use
/// (the source image's size); space goes there first. most: never larger.
struct GrowthLimit {
    RectangleSize least, wanted_most, most;
};

constexpr uint64_t kMostCells = uint64_t{1} << 26;

/// New places for the rectangles of a layout, like packing.places; no rectangle becomes smaller than `least` in either
/// side and none larger than `most`. kSubtrees covers the bin completely unless `most` keeps it from it, in steps of
/// one unit: each cut divides the space that its two sides do not need in proportion to their room up to `wanted_most`,
/// then up to `most`; what nobody may take stays empty. kSiblingLeaves regards `most`, not `wanted_most`. Preconditions
/// (programming errors): the tree is the one of a complete packing of sizes `least` into `bin`, limits.size() ==
/// packing.places.size(). A packing without a tree (skyline) comes back as it is but for kInPlace. Linear time
/// (kInPlace: in the bin's area, and a byte of memory for each of its units).
std::vector<Rectangle> fill_leaves(const Packing& packing, RectangleSize bin, std::span<const GrowthLimit> limits,
                                   FillMode mode);

}  // namespace citystream::codec::atlas
