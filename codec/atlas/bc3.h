// BC3 blocks (BC4 alpha, then four-colour BC1: 16 bytes), and what a chart's alpha needs.
#pragma once

#include <cstdint>
#include <span>

#include "codec/atlas/bc1.h"

namespace citystream::codec::atlas {

enum class AlphaKind {
    kNone,    ///< all opaque: BC1
    kCutOut,  ///< there or not: BC1 with cut-outs, 8 bytes a block (bc1_cutout.h)
    kSmooth,  ///< BC3, 16 bytes a block
};

/// What an RGBA image (4 bytes a texel) needs when values that are within `tolerance` of 0 or 255 count as these.
AlphaKind alpha_kind(std::span<const uint8_t> rgba, uint8_t tolerance = 8);

/// The colours of a block (16 RGBA texels), the mean of the others where alpha is 0: what encode_bc3_block gives to the
/// BC1 encoder. A rate-distortion encoder (bc1_rate.h) takes the same.
Bc1Texels bc3_colours(const uint8_t rgba[64]);

/// Encodes 16 RGBA texels (row-major, not premultiplied) to four words: BC4 of alpha, then BC1. The colours of texels
/// of alpha 0 do not matter and cost nothing: they are taken for the mean of the others.
void encode_bc3_block(const uint8_t rgba[64], const Bc1Options& options, uint32_t out[4]);

/// Texel `i` (0..15). Any bytes; the colour is always read in four-colour mode. Twin: bc3_texel in
/// shaders/bc_blocks.glsl.
void decode_bc3_texel(const uint32_t block[4], uint32_t i, uint8_t rgba[4]);

}  // namespace citystream::codec::atlas
