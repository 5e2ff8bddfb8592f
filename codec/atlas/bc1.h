// BC1 blocks: 4 x 4 texels in 8 bytes, always in the four-colour mode. Encoder of our own; the decoder's integers are
// the format.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/bc1_fit.h"

namespace citystream::codec::atlas {

struct Bc1Options {
    ChannelWeights weights;  ///< of the squared error that is kept small
    PartitionSearch search = PartitionSearch::kAll;
    /// Rounds of endpoints and indices after the partition, each while it lowers the error. 1: fastest; more than 8
    /// gains nothing.
    int rounds = 4;
    /// Then every endpoint's channel is tried one step up and down, until no step helps: 0.01 dB for 14 to 30 % of
    /// the speed.
    bool steps = false;
};

/// Encodes 16 RGB texels (row-major, 3 bytes each) to two words (c0 | c1 << 16, 2-bit indices). Equal texels give the
/// nearest constant block. c0 == c1 with all indices 0, or c0 > c1: never the three-colour mode. Whole images are
/// faster block by block with encode_bc1_blocks, with the same result.
void encode_bc1_block(const uint8_t rgb[48], uint32_t out[2]);

/// The best block found for every 16 texels, ordered as above, with its error.
void encode_bc1_blocks(std::span<const Bc1Texels> blocks, const Bc1Options& options, std::span<Bc1Block> out);

/// The blocks of an image (RGB, row-major, 3 * width * height bytes; sides >= 1), bottom row of blocks first as the
/// image's rows go; beyond its edges the last column and row repeat. ceil(width / 4) * ceil(height / 4) of them.
std::vector<Bc1Texels> bc1_blocks_of(std::span<const uint8_t> rgb, uint32_t width, uint32_t height);

/// Two words a block: what layers hold.
std::vector<uint32_t> encode_bc1_image(std::span<const uint8_t> rgb, uint32_t width, uint32_t height,
                                       const Bc1Options& options = {});

/// Colour of texel `i` (0..15, row-major) of a block. Endpoints expand 5/6 bits by replication; thirds are (2a + b + 1)
/// / 3. Works on any bytes (c0 <= c1 is read in four-colour mode too). Twin: bc1_texel in shaders/bc_blocks.glsl.
void decode_bc1_texel(const uint32_t block[2], uint32_t i, uint8_t rgb[3]);

}  // namespace citystream::codec::atlas
