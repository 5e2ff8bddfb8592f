#include "codec/atlas/bc1_cutout.h"

#include <algorithm>

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kTexels = 16;
constexpr uint32_t kNothing = 3;
constexpr int32_t kLevels[3] = {32, 64, 32};
constexpr uint32_t kShift[3] = {11, 5, 0};

int32_t expand(uint32_t colour, int channel) {
    const uint32_t level = colour >> kShift[channel] & static_cast<uint32_t>(kLevels[channel] - 1);
    return static_cast<int32_t>(channel == 1 ? level << 2 | level >> 4 : level << 3 | level >> 2);
}

void three_colours(uint32_t endpoints, int32_t palette[3][3]) {
    for (int c = 0; c < 3; ++c) {
        palette[0][c] = expand(endpoints & 0xffffu, c);
        palette[1][c] = expand(endpoints >> 16, c);
        palette[2][c] = (palette[0][c] + palette[1][c] + 1) / 2;
    }
}

/// The texels that are there.
struct Opaque {
    int32_t colour[kTexels][3];
    uint32_t texel[kTexels];
    uint32_t count = 0;
};

Opaque opaque_texels(const uint8_t rgba[64]) {
    Opaque opaque;
    for (uint32_t i = 0; i < kTexels; ++i) {
        if (rgba[4 * i + 3] < 128) continue;
        for (uint32_t c = 0; c < 3; ++c) opaque.colour[opaque.count][c] = rgba[4 * i + c];
        opaque.texel[opaque.count++] = i;
    }
    return opaque;
}

struct CutoutFit {
    uint32_t endpoints = 0;
    uint32_t code[kTexels] = {};  ///< of the opaque texels in turn
    uint64_t error = 0;
};

CutoutFit fit_codes(const Opaque& opaque, const ChannelWeights& weights, uint32_t endpoints) {
    CutoutFit fit{endpoints};
    int32_t palette[3][3];
    three_colours(endpoints, palette);
    for (uint32_t i = 0; i < opaque.count; ++i) {
        uint64_t least = ~uint64_t{0};
        for (uint32_t code = 0; code < 3; ++code) {
            uint64_t error = 0;
            for (int c = 0; c < 3; ++c) {
                const int32_t difference = palette[code][c] - opaque.colour[i][c];
                error += static_cast<uint64_t>(difference * difference) * weights.weight[c];
            }
            if (error >= least) continue;
            least = error;
            fit.code[i] = code;
        }
        fit.error += least;
    }
    return fit;
}

uint32_t nearest_565(const int32_t rgb[3]) {
    uint32_t colour = 0;
    for (int c = 0; c < 3; ++c) {
        const int32_t last = kLevels[c] - 1;
        colour |= static_cast<uint32_t>((std::clamp(rgb[c], 0, 255) * last * 2 + 255) / 510) << kShift[c];
    }
    return colour;
}

/// The two texels that are furthest apart.
uint32_t furthest_pair(const Opaque& opaque, const ChannelWeights& weights) {
    uint64_t furthest = 0;
    uint32_t a = 0, b = 0;
    for (uint32_t i = 0; i < opaque.count; ++i) {
        for (uint32_t j = i + 1; j < opaque.count; ++j) {
            uint64_t distance = 0;
            for (int c = 0; c < 3; ++c) {
                const int32_t difference = opaque.colour[i][c] - opaque.colour[j][c];
                distance += static_cast<uint64_t>(difference * difference) * weights.weight[c];
            }
            if (distance <= furthest) continue;
            furthest = distance;
            a = i;
            b = j;
        }
    }
    return nearest_565(opaque.colour[a]) | nearest_565(opaque.colour[b]) << 16;
}

/// Least squares for the codes of a fit; the same endpoints where these do not determine any.
uint32_t refit(const Opaque& opaque, const CutoutFit& fit) {
    constexpr int64_t kWeight[3] = {2, 0, 1};  // halves of c0
    int64_t aa = 0, ab = 0, bb = 0, at[3] = {}, bt[3] = {};
    for (uint32_t i = 0; i < opaque.count; ++i) {
        const int64_t a = kWeight[fit.code[i]], b = 2 - a;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        for (int c = 0; c < 3; ++c) {
            at[c] += a * opaque.colour[i][c];
            bt[c] += b * opaque.colour[i][c];
        }
    }
    const int64_t determinant = aa * bb - ab * ab;
    if (determinant == 0) return fit.endpoints;
    int32_t from[3], to[3];
    for (int c = 0; c < 3; ++c) {
        from[c] = static_cast<int32_t>(std::clamp<int64_t>(2 * (bb * at[c] - ab * bt[c]) / determinant, 0, 255));
        to[c] = static_cast<int32_t>(std::clamp<int64_t>(2 * (aa * bt[c] - ab * at[c]) / determinant, 0, 255));
    }
    return nearest_565(from) | nearest_565(to) << 16;
}

/// Tries neighbours of the endpoints, one channel of one of them at a time.
CutoutFit step_endpoints(const Opaque& opaque, const ChannelWeights& weights, CutoutFit best) {
    constexpr uint32_t kField[6] = {0, 5, 11, 16, 21, 27};
    constexpr uint32_t kMask[6] = {31, 63, 31, 31, 63, 31};
    int since = 0;
    for (int k = 0; since < 12 && best.error > 0; k = (k + 1) % 12, ++since) {
        const uint32_t level = best.endpoints >> kField[k / 2] & kMask[k / 2];
        if (level == (k % 2 == 0 ? 0 : kMask[k / 2])) continue;
        const uint32_t step = 1u << kField[k / 2];
        const CutoutFit stepped =
            fit_codes(opaque, weights, k % 2 == 0 ? best.endpoints - step : best.endpoints + step);
        if (stepped.error >= best.error) continue;
        best = stepped;
        since = -1;
    }
    return best;
}

CutoutFit fit_opaque(const Opaque& opaque, const ChannelWeights& weights) {
    CutoutFit best = fit_codes(opaque, weights, furthest_pair(opaque, weights));
    for (int round = 0; round < 4; ++round) {
        const CutoutFit next = fit_codes(opaque, weights, refit(opaque, best));
        if (next.error >= best.error) break;
        best = next;
    }
    return step_endpoints(opaque, weights, best);
}

}  // namespace

void encode_bc1_cutout_block(const uint8_t rgba[64], const Bc1Options& options, uint32_t out[2]) {
    const Opaque opaque = opaque_texels(rgba);
    if (opaque.count == kTexels) {
        Bc1Texels texels;
        for (size_t i = 0; i < kTexels; ++i) {
            for (size_t c = 0; c < 3; ++c) texels.channel[c][i] = rgba[4 * i + c];
        }
        Bc1Block block;
        encode_bc1_blocks(std::span(&texels, 1), options, std::span(&block, 1));
        out[0] = block.endpoints;
        out[1] = block.indices;
        return;
    }
    out[0] = 0;
    out[1] = ~0u;
    if (opaque.count == 0) return;
    const CutoutFit fit = fit_opaque(opaque, options.weights);
    const uint32_t c0 = fit.endpoints & 0xffffu, c1 = fit.endpoints >> 16;
    const bool exchange = c0 > c1;
    out[0] = exchange ? c1 | c0 << 16 : fit.endpoints;
    for (uint32_t i = 0; i < opaque.count; ++i) {
        const uint32_t code = exchange && fit.code[i] < 2 ? 1 - fit.code[i] : fit.code[i];
        out[1] ^= (kNothing ^ code) << (2 * opaque.texel[i]);
    }
}

void decode_bc1_cutout_texel(const uint32_t block[2], uint32_t i, uint8_t rgba[4]) {
    rgba[3] = 255;
    if ((block[0] & 0xffffu) > block[0] >> 16) {
        decode_bc1_texel(block, i, rgba);
        return;
    }
    const uint32_t code = block[1] >> (2 * i) & 3u;
    int32_t palette[3][3];
    three_colours(block[0], palette);
    for (int c = 0; c < 3; ++c) rgba[c] = code == kNothing ? uint8_t{0} : static_cast<uint8_t>(palette[code][c]);
    if (code == kNothing) rgba[3] = 0;
}

}  // namespace citystream::codec::atlas
