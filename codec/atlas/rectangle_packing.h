// Packing rectangles into one bin without overlap and without turning them: the first atlas's binary tree, and two
// stronger packers that choose a rectangle for a place instead of a place for a rectangle.
//
// Source: "Space-Optimized Texture Atlases" (Martinez Bayona 2009), 7.3.1 (size prediction) and Algorithms 3 and 4,
// as corrected in the notes: prediction in integers, sorting key stated, search pruned. All sizes are whole numbers of
// whatever unit the caller packs in (rectangle_packing_atlas.h: cells of 4 * 2^M texels). The same input gives the same
// layout on every machine: no floating point, no unordered container, ties broken by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::atlas {

struct RectangleSize {
    uint32_t width = 0, height = 0;
    uint64_t area() const { return uint64_t{width} * height; }
    bool fits_in(RectangleSize other) const { return width <= other.width && height <= other.height; }
    bool operator==(const RectangleSize&) const = default;
};

/// Columns x .. x + width - 1, rows y .. y + height - 1. Width 0: not placed.
struct Rectangle {
    uint32_t x = 0, y = 0, width = 0, height = 0;
    uint64_t area() const { return uint64_t{width} * height; }
    RectangleSize size() const { return {width, height}; }
    bool operator==(const Rectangle&) const = default;
};

/// Most rectangles in one call and largest side of a bin: areas and their sums fit 64 bits many times over.
constexpr size_t kMostRectangles = size_t{1} << 24;
constexpr uint32_t kMaxBinSide = 1u << 16;

/// Sum of the areas.
uint64_t total_area(std::span<const RectangleSize> sizes);

/// 7.3.1 in integers: alpha = ceil(log2(area)), width = 2^ceil(alpha / 2), height = 2^floor(alpha / 2). So both sides
/// are powers of two, width is height or twice it, and width * height / 2 < area <= width * height. Area 0 gives 1 x 1.
RectangleSize predicted_bin(uint64_t area);

/// The predicted bin of their total area where each of them alone fits it; else the smallest powers of two that each
/// fits alone, doubled (next_bin) until the total area fits: one 4 x 4096 chart asks for 4 x 4096, not for 4096 x 4096.
RectangleSize smallest_bin(std::span<const RectangleSize> sizes);

/// alpha + 1: twice the area, the shorter side doubled (the width where they are equal).
RectangleSize next_bin(RectangleSize bin);

/// How a bin was cut into rectangles by straight cuts from side to side: what leaf fill works on.
struct SlicingNode {
    enum class Cut : uint8_t {
        kNone,    ///< a leaf: holds `rectangle`, or is empty
        kAcross,  ///< first is left of second
        kUp,      ///< first is below second
    };
    static constexpr uint32_t kEmpty = ~uint32_t{0};
    Cut cut = Cut::kNone;
    uint32_t rectangle = kEmpty;     ///< of a leaf: index of the rectangle that it holds
    uint32_t first = 0, second = 0;  ///< node numbers, both greater than the node's own
};

/// Node 0 is the whole bin. Children come after their parents: one loop backwards sees children first, one forwards
/// parents first; nothing needs recursion.
struct SlicingTree {
    std::vector<SlicingNode> nodes;
};

struct Packing {
    std::vector<Rectangle> places;  ///< like the sizes given; width 0 where one did not fit
    size_t placed = 0;
    SlicingTree tree;  ///< no nodes: the layout is not made of straight cuts (skyline)
    bool complete() const { return placed == places.size(); }
};

enum class PackMethod : uint8_t {
    kBinaryTree,  ///< Algorithms 3 and 4: largest area first, first fit, split along the axis with more slack
    kGuillotine,  ///< ours: free rectangles depth first, each takes the rectangle that fits it best; cut like the tree
    kSkyline,     ///< ours: the lowest gap of the skyline takes the rectangle that fits it best; not a tree
};

/// Variants of kGuillotine and kSkyline (what "best" weighs; see the .cpp). None is best for all sets. kBinaryTree has
/// one.
constexpr uint32_t kPackTastes = 4;

enum class PackWhole : uint8_t {
    kAllOrNothing,  ///< give up as soon as it is clear that not all fit (the places are then of no use)
    kAsManyAsFit,   ///< go on to the end: the rest is for the next bin
};

/// Packs. Preconditions (programming errors): sides of the sizes 1..kMaxBinSide, of the bin 1..kMaxBinSide,
/// sizes.size() <= kMostRectangles, taste < kPackTastes. A size larger than the bin is not placed.
/// Time: kBinaryTree near n log n (the search skips subtrees whose largest free width or height is too small).
/// The other two: n times the number of distinct widths left (at most the bin's width).
Packing pack_rectangles(std::span<const RectangleSize> sizes, RectangleSize bin, PackMethod method, uint32_t taste = 0,
                        PackWhole whole = PackWhole::kAllOrNothing);

/// Whether all placed rectangles lie inside the bin and none overlaps another. n log n.
bool layout_is_valid(std::span<const Rectangle> places, RectangleSize bin);

}  // namespace citystream::codec::atlas
