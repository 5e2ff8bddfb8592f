// Resizing images in linear light, one axis at a time. Shrinking filters first (so that nothing aliases and nothing
// darkens: pitfall 15 of a gamma-space box); enlarging is what a GPU's bilinear filter shows. The thesis's plain
// bilinear point sampling (section 7.1) is kept for comparison. Deterministic.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "codec/atlas/image.h"
#include "codec/atlas/image_rows.h"

namespace citystream::codec::atlas {

/// How an image is made smaller.
enum class Shrink : uint8_t {
    kArea,      ///< mean over each new texel's footprint, partial texels by their share
    kLanczos,   ///< sinc windowed by a sinc of three lobes, scaled to the footprint; keeps more detail, may overshoot
    kBilinear,  ///< two taps at the new texel's centre without a prefilter: the thesis's, aliases below half size
};

/// What lies beyond the edges: the image again (a chart that repeats), or its outermost texels.
struct Edges {
    bool repeat_u = false, repeat_v = false;
};

/// Texels of a `width` x `height` image; row 0 stays row 0. Sizes of 1 .. 65535; a size equal to the image's leaves
/// that axis as it is, a smaller one shrinks by `filter`, a larger one enlarges bilinearly. Results of kLanczos are
/// clamped to 0..1. Precondition (programming error): the image is not empty, sizes in range.
/// O(area * taps); about 4 taps per source texel and axis.
Image resample(const Image& image, uint32_t width, uint32_t height, Shrink filter, Edges edges = {});

/// The same of an image in bytes, converted strip by strip: of a huge image that shrinks, only `width` x its height
/// texels exist as floats at a time.
Image resample(const ChartImage& image, uint32_t width, uint32_t height, Shrink filter, Edges edges = {});

/// One axis of the same.
Image resample_width(const Image& image, uint32_t width, Shrink filter, bool repeat);
Image resample_height(const Image& image, uint32_t height, Shrink filter, bool repeat);

/// A small image as bilinear filtering shows it at a larger size: the texels of resample(small, width, height, ...),
/// made strip by strip. Precondition: no side shrinks; `small` outlives the result.
ImageRows enlarged_rows(const Image& small, uint32_t width, uint32_t height, Edges edges = {});

/// "area", "lanczos", "bilinear".
std::optional<Shrink> parse_shrink(std::string_view text);
std::string_view name_of(Shrink filter);

}  // namespace citystream::codec::atlas
