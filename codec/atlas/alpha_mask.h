// What images with alpha need beside their colours. Alpha is tested and never blended: where it is filtered to at least
// one half something is there, elsewhere nothing. A plain filter then lets fences vanish or close when they are made
// smaller; here the share of the area that is there stays, and where a filter leaves nothing but an even grey, an
// ordered pattern stands for it. Integers throughout: the same bytes on every machine.
#pragma once

#include <cstdint>
#include <span>

#include "codec/atlas/atlas_layer.h"

namespace citystream::codec::atlas {

/// Mips of an image with alpha end at the last one of this many texels: fewer cannot be there in part.
inline constexpr uint32_t kLeastAlphaTexels = 64;

/// Whether no texel fails the test: such an image needs no alpha.
bool all_there(std::span<const uint8_t> alpha);

/// A share of an area, part / whole; whole is not 0.
struct AreaShare {
    uint64_t part = 0, whole = 1;
    double value() const { return static_cast<double>(part) / static_cast<double>(whole); }
};

/// The share of an image that passes the test under bilinear filtering, continued beyond its edges as its repeat flags
/// say: sixteen places a texel. All of it without alpha. O(texels).
AreaShare there_of(const ChartImage& image);

/// Changes the alpha of an image that was made smaller so that `share` of it is there, as nearly as its texels can
/// show. O(texels). Nothing without alpha.
void keep_share(ChartImage& image, AreaShare share);

/// Gives texels of alpha 0 the colours of what is there around them, so that filtering across the edge shows no others.
/// O(texels). Nothing without alpha.
void fill_hidden_colours(ChartImage& image);

/// The next coarser mip of an image with alpha, as `downsample` makes it: colours weigh by alpha, and as much is there.
ChartImage downsample_masked(const ChartImage& image);

}  // namespace citystream::codec::atlas
