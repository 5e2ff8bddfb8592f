// BC1 blocks with cut-out alpha: a texel is opaque or not there. c0 > c1: the four opaque colours of bc1.h; otherwise
// three opaque colours (c0, c1, (c0 + c1 + 1) / 2) and code 3, nothing. Half the bytes of BC3.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/bc1.h"

namespace citystream::codec::atlas {

/// Encodes 16 RGBA texels (row-major); alpha below 128 is not there, and its colour does not matter. All texels opaque:
/// the block of encode_bc1_blocks.
void encode_bc1_cutout_block(const uint8_t rgba[64], const Bc1Options& options, uint32_t out[2]);

/// Texel `i` (0..15): alpha 0 (then r, g, b are 0 too: premultiplied) or 255. Any bytes. Twin: bc1_cutout_texel in
/// shaders/bc_blocks.glsl.
void decode_bc1_cutout_texel(const uint32_t block[2], uint32_t i, uint8_t rgba[4]);

}  // namespace citystream::codec::atlas
