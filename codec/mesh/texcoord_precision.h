// Texture coordinates at the precision that the finest mip on show needs (Meyer 2012, section 3.8, P11): one bit less a
// mip, down to none. They lie in precision buffers of two components (adaptive_precision.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/adaptive_precision.h"

namespace citystream::codec::mesh {

/// Texture coordinates of one image, packed. `u` and `v` in 2^-16 repeats.
struct TexcoordWords {
    PrecisionShape shape;         ///< two components; one bit less is one mip less
    std::vector<uint32_t> words;  ///< two a vertex
    std::array<int32_t, 2> base{};
    std::array<uint32_t, 2> shift{};  ///< low bits that a component never has: the image is shorter that way

    /// A coordinate in 2^-16 repeats from fetched words of `level` bits: the middle of what they leave open.
    std::array<int32_t, 2> coordinate(const std::array<uint32_t, 2>& fetched, uint32_t level) const;
};

/// Bits that an image's longer side of `texels` needs a repeat at a mip, of which `fraction_bits` are within a texel:
/// ceil(log2(texels)) - mip (at least 0) + fraction_bits, at most 16.
uint32_t texcoord_bits(uint32_t texels, uint32_t mip, uint32_t fraction_bits);

/// Bit level of a buffer for a mip: its full bits less the 16 - texcoord_bits that are dropped.
uint32_t texcoord_level(const TexcoordWords& words, uint32_t texels, uint32_t mip, uint32_t fraction_bits);

/// Packs coordinates that span less than 2^31 (32,768 repeats). Images have at least one texel each way.
TexcoordWords texcoord_words(std::span<const std::array<int32_t, 2>> coordinates, uint32_t width, uint32_t height);

}  // namespace citystream::codec::mesh
