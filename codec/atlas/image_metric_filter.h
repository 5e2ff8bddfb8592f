// Separable filters of equal size in and out, for the image metrics.
#pragma once

#include <vector>

#include "codec/atlas/image.h"

namespace citystream::codec::atlas {

using Kernel = std::vector<float>;  ///< odd length, centred

/// Gaussian weights summing to 1; sigma > 0.
Kernel gaussian_kernel(double sigma, uint32_t radius);

/// What a filter sees beyond the edges.
enum class Beyond : uint8_t {
    kEdge,    ///< the outermost texel
    kMirror,  ///< the image mirrored at its outermost texels (not repeating them); of one texel: that texel
};

/// Every plane filtered along its rows, its columns, or both. Kernels may be longer than the image. O(texels * taps).
Image filter_rows(const Image& image, const Kernel& kernel, Beyond beyond);
Image filter_columns(const Image& image, const Kernel& kernel, Beyond beyond);
Image filter_both(const Image& image, const Kernel& kernel, Beyond beyond);

/// Sum of one plane's values: in double, in an order that does not depend on how wide the processor is.
double sum_of(std::span<const float> values);

}  // namespace citystream::codec::atlas
