// Stretch optimisation: how large rectangles can be made, between a least and a most size of each, so that they still
// all fit one bin.
//
// Source: "Space-Optimized Texture Atlases" 7.3.3, Algorithm 6. There success or failure moves the bounds of all
// rectangles together, so it bisects one parameter that they share; here that parameter is a whole number. Whether a
// set fits is not monotone in it (pitfall 16 of the notes): the last layout that did fit is kept, and after the
// bisection a few steps above it are tried, too. Beyond the paper: what is then left over goes to single rectangles,
// one unit each, to as many of them as fit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/atlas/rectangle_packing.h"

namespace citystream::codec::atlas {

/// Which packers are tried, the first complete layout wins.
enum class PackEffort : uint8_t {
    kBinaryTree,     ///< Algorithms 3 and 4 alone, as the paper does
    kStrongestTree,  ///< kGuillotine in all tastes, then the binary tree: layouts that can be filled to 100 %
    kStrongest,      ///< kSkyline in all tastes, too: denser as it is, but what is left empty stays empty
};

/// A complete layout by the first packer of `effort` that finds one. `hint`: where to begin (and where it was found).
std::optional<Packing> pack_with_effort(std::span<const RectangleSize> sizes, RectangleSize bin, PackEffort effort,
                                        uint32_t& hint);

/// The layout, of all those that the packers of `effort` make, that covers most of a bin that is too small for all.
Packing pack_as_many_as_fit(std::span<const RectangleSize> sizes, RectangleSize bin, PackEffort effort);

struct StretchRange {
    RectangleSize least, most;  ///< least fits in most
};

constexpr uint32_t kStretchSteps = 4096;

struct StretchResult {
    Packing packing;                   ///< complete
    std::vector<RectangleSize> sizes;  ///< of the rectangles in it, between least and most
    uint32_t stretch = 0;              ///< of kStretchSteps: how far all have come from least to most
    uint32_t layouts = 0;              ///< how many sets of sizes were tried
};

/// The size at `stretch` of kStretchSteps, rounded down.
RectangleSize stretched(const StretchRange& range, uint32_t stretch);

/// None: no ranges, or not even the least sizes fit. Some 25 + max(4, 8192 / n) (log2 n + 1) sets of sizes are packed
/// at most, each by up to nine packers (kStrongest); preconditions as of pack_rectangles.
std::optional<StretchResult> optimise_stretch(std::span<const StretchRange> ranges, RectangleSize bin,
                                              PackEffort effort);

}  // namespace citystream::codec::atlas
