// The images that charts are made from, in linear light: what resampling, metrics and the search work on. Pure
// arithmetic: the same bytes in give the same bytes out on every machine with IEEE floats.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"

namespace citystream::codec::atlas {

/// Linear light, 0..1, one plane per channel. 3 channels: R, G, B. 4 channels: R, G, B multiplied by alpha, then alpha,
/// so that filters need no special case. 1 channel: grey. Row 0 is the bottom (v = 0), as in ChartImage.
struct Image {
    uint32_t width = 0, height = 0, channels = 0;
    std::vector<float> texels;  ///< channels * height * width: plane after plane, row after row

    Image() = default;
    Image(uint32_t w, uint32_t h, uint32_t c) : width(w), height(h), channels(c), texels(size_t{w} * h * c) {}

    size_t area() const { return size_t{width} * height; }
    bool empty() const { return texels.empty(); }
    std::span<float> plane(uint32_t c) { return {texels.data() + c * area(), area()}; }
    std::span<const float> plane(uint32_t c) const { return {texels.data() + c * area(), area()}; }
    std::span<float> row(uint32_t c, uint32_t y) { return plane(c).subspan(size_t{y} * width, width); }
    std::span<const float> row(uint32_t c, uint32_t y) const { return plane(c).subspan(size_t{y} * width, width); }
    float& at(uint32_t x, uint32_t y, uint32_t c) {
        assert(x < width && y < height && c < channels);
        return texels[c * area() + size_t{y} * width + x];
    }
    float at(uint32_t x, uint32_t y, uint32_t c) const {
        assert(x < width && y < height && c < channels);
        return texels[c * area() + size_t{y} * width + x];
    }
    bool operator==(const Image&) const = default;
};

/// IEC 61966-2-1 decoding of an 8-bit value, 0..1. One table look-up.
float linear_of_srgb(uint8_t value);

/// The 8-bit value whose decoding is nearest in the encoded scale; exact (linear_of_srgb's values give their own byte).
/// Outside 0..1 clamps, NaN gives 0.
uint8_t srgb_of_linear(float value);

/// The real sRGB encoding of linear light: out[i] within 1e-6 of the formula for in[i] in 0..1, values outside are
/// clamped. Same sizes; the spans may be the same, else must not overlap. About 1 ns a value.
void encode_srgb(std::span<const float> in, std::span<float> out);

/// 3 channels, 4 with alpha. Precondition (programming error): rgb.size() == 3 * width * height.
Image linear_image(const ChartImage& image);
/// Rows y .. y + count - 1 of the same.
Image linear_rows(const ChartImage& image, uint32_t y, uint32_t count);

/// From interleaved sRGB bytes of 1 (grey), 3 (RGB) or 4 channels (RGB not multiplied by alpha, alpha linear).
/// Precondition: bytes.size() == channels * width * height.
Image linear_image(uint32_t width, uint32_t height, uint32_t channels, std::span<const uint8_t> bytes);

/// Back to interleaved sRGB bytes, rounded to nearest; a texel of alpha 0 is black.
std::vector<uint8_t> srgb_bytes(const Image& image);

/// The bytes as a chart: colours (grey is repeated; divided by alpha) and alpha where there are four channels. Repeat
/// flags and metres_per_texel are left for the caller.
ChartImage chart_image(const Image& image);

/// The same picture as its 8-bit bytes show it: linear_image(srgb_bytes(image)), in place. Of alpha 0 the colour is
/// black then.
void quantise(Image& image);

/// What is drawn of a picture with alpha: the colour where alpha is at least one half, elsewhere nothing (alpha 0).
/// Pictures without alpha stay as they are.
void test_alpha(Image& image);

}  // namespace citystream::codec::atlas
