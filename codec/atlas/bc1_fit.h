// The two halves of fitting a BC1 block in the format's integers: the best indices for endpoints, and the best
// endpoints for indices. Errors are whole numbers: the weighted squared differences of 16 texels, as decode_bc1_texel
// shows them.
#pragma once

#include <cstdint>

#include "codec/atlas/bc1_partition.h"

namespace citystream::codec::atlas {

struct Bc1Block {
    uint32_t endpoints = 0;  ///< c0 | c1 << 16
    uint32_t indices = 0;
    uint32_t error = 0;  ///< at most 16 * 255^2 * (sum of weights) < 2^29
};

/// The four colours of a block, in the order of the codes: c0, c1, (2 c0 + c1 + 1) / 3, (c0 + 2 c1 + 1) / 3.
void bc1_palette(uint32_t endpoints, int32_t palette[4][3]);

/// Texels of 16 RGB triples, row-major.
Bc1Texels bc1_texels(const uint8_t rgb[48]);

/// The nearest colour for every texel (the lowest code among equals). Endpoints are exchanged where that is needed for
/// c0 >= c1; equal ones give indices 0.
Bc1Block fit_bc1_indices(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints);

/// Squared errors of every texel with every code (endpoints as they are): error[code][texel].
void bc1_code_errors(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints, float error[4][16]);

/// Endpoints for given indices: least squares, then the best point of the grid of endpoints in the 3 x 3 neighbourhood,
/// channel by channel, by the exact error. Indices that use one code alone give its nearest constant colour.
/// Not ordered: the endpoints fit the indices as they are. `error` is that of the endpoints and indices.
Bc1Block fit_bc1_endpoints(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t indices);

/// The same block with c0 >= c1, indices 0 where they are equal.
Bc1Block ordered_bc1(const Bc1Block& block);

/// Endpoints whose code 2 is nearest to a colour.
uint32_t bc1_constant_endpoints(const int32_t rgb[3]);

}  // namespace citystream::codec::atlas
