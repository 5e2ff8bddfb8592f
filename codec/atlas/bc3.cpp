#include "codec/atlas/bc3.h"

#include <cassert>

#include "codec/atlas/bc4.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kTexels = 16;

}  // namespace

Bc1Texels bc3_colours(const uint8_t rgba[64]) {
    uint32_t sum[3] = {}, seen = 0;
    for (uint32_t i = 0; i < kTexels; ++i) {
        if (rgba[4 * i + 3] == 0) continue;
        ++seen;
        for (uint32_t c = 0; c < 3; ++c) sum[c] += rgba[4 * i + c];
    }
    Bc1Texels texels;
    for (uint32_t i = 0; i < kTexels; ++i) {
        for (uint32_t c = 0; c < 3; ++c) {
            const uint32_t mean = seen == 0 ? 0 : (sum[c] + seen / 2) / seen;
            texels.channel[c][i] = static_cast<float>(rgba[4 * i + 3] == 0 ? mean : rgba[4 * i + c]);
        }
    }
    return texels;
}

AlphaKind alpha_kind(std::span<const uint8_t> rgba, uint8_t tolerance) {
    assert(rgba.size() % 4 == 0);
    bool opaque = true;
    for (size_t i = 3; i < rgba.size(); i += 4) {
        const bool full = rgba[i] >= 255 - tolerance;
        if (!full && rgba[i] > tolerance) return AlphaKind::kSmooth;
        opaque = opaque && full;
    }
    return opaque ? AlphaKind::kNone : AlphaKind::kCutOut;
}

void encode_bc3_block(const uint8_t rgba[64], const Bc1Options& options, uint32_t out[4]) {
    uint8_t alpha[kTexels];
    for (uint32_t i = 0; i < kTexels; ++i) alpha[i] = rgba[4 * i + 3];
    encode_bc4_block(alpha, out);
    const Bc1Texels texels = bc3_colours(rgba);
    Bc1Block block;
    encode_bc1_blocks(std::span(&texels, 1), options, std::span(&block, 1));
    out[2] = block.endpoints;
    out[3] = block.indices;
}

void decode_bc3_texel(const uint32_t block[4], uint32_t i, uint8_t rgba[4]) {
    decode_bc1_texel(block + 2, i, rgba);
    rgba[3] = decode_bc4_texel(block, i);
}

}  // namespace citystream::codec::atlas
