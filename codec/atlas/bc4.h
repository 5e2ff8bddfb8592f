// BC4 blocks: one channel (alpha) of 4 x 4 texels in 8 bytes. Two end values and 3 bits a texel. The decoder's integers
// are the format.
#pragma once

#include <cstdint>

namespace citystream::codec::atlas {

/// Encodes 16 values (row-major) to two words: bits 0..7 a0, 8..15 a1, then 3 bits a texel. Chooses between the mode of
/// eight values and that of six with 0 and 255. Exact: one value, any two values, 0 and 255 beside any two others.
/// About 40 fits of 16 texels.
void encode_bc4_block(const uint8_t values[16], uint32_t out[2]);

/// Value of texel `i` (0..15). a0 > a1: codes 2..7 are ((8 - code) a0 + (code - 1) a1 + 3) / 7; otherwise codes 2..5
/// are
/// ((6 - code) a0 + (code - 1) a1 + 2) / 5, 6 is 0 and 7 is 255. Any bytes. Twin: bc4_texel in shaders/bc_blocks.glsl.
uint8_t decode_bc4_texel(const uint32_t block[2], uint32_t i);

}  // namespace citystream::codec::atlas
