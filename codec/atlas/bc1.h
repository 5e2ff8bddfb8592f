// BC1 blocks: 4 x 4 texels in 8 bytes, always in the four-colour mode. Encoder of our own; the decoder's integers are
// the format.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::atlas {

/// Encodes 16 RGB texels (row-major, 3 bytes each) to two words (c0 | c1 << 16, 2-bit indices). Equal texels give the
/// nearest constant block. c0 == c1 with all indices 0, or c0 > c1: never the three-colour mode.
void encode_bc1_block(const uint8_t rgb[48], uint32_t out[2]);

/// Colour of texel `i` (0..15, row-major) of a block. Endpoints expand 5/6 bits by replication; thirds are (2a + b + 1)
/// / 3. Works on any bytes (c0 <= c1 is read in four-colour mode too). Twin: bc1_texel in shaders/atlas_sample.glsl.
void decode_bc1_texel(const uint32_t block[2], uint32_t i, uint8_t rgb[3]);

}  // namespace citystream::codec::atlas
