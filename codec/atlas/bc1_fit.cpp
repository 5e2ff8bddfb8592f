#include "codec/atlas/bc1_fit.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr int32_t kLevels[3] = {32, 64, 32};
constexpr uint32_t kShift[3] = {11, 5, 0};

constexpr int32_t expand(int32_t value, int32_t levels) {
    return levels == 64 ? value << 2 | value >> 4 : value << 3 | value >> 2;
}

/// Colours of codes 0, 1, 2, 3 of a channel for every pair of endpoints.
template <int kCount>
struct PairTable {
    uint8_t colour[kCount][kCount][4];

    constexpr PairTable() : colour() {
        for (int a = 0; a < kCount; ++a) {
            for (int b = 0; b < kCount; ++b) {
                const int32_t from = expand(a, kCount), to = expand(b, kCount);
                const int32_t colours[4] = {from, to, (2 * from + to + 1) / 3, (from + 2 * to + 1) / 3};
                for (int code = 0; code < 4; ++code) colour[a][b][code] = static_cast<uint8_t>(colours[code]);
            }
        }
    }
};
constexpr PairTable<32> kFive;
constexpr PairTable<64> kSix;

const uint8_t* pair_colours(int channel, int32_t a, int32_t b) {
    return channel == 1 ? kSix.colour[a][b] : kFive.colour[a][b];
}

uint32_t channel_of(uint32_t colour, int channel) {
    return colour >> kShift[channel] & static_cast<uint32_t>(kLevels[channel] - 1);
}

struct ConstantPair {
    uint8_t a = 0, b = 0;
};

/// For every value the endpoints whose code 2 is nearest to it.
std::array<ConstantPair, 256> constant_pairs(int channel) {
    std::array<ConstantPair, 256> pairs;
    for (int32_t value = 0; value < 256; ++value) {
        int32_t least = 1 << 30;
        for (int32_t a = 0; a < kLevels[channel]; ++a) {
            for (int32_t b = 0; b < kLevels[channel]; ++b) {
                const uint8_t* colours = pair_colours(channel, a, b);
                // Among equally near pairs the closest together: least harm where a sampler blends differently.
                const int32_t cost = std::abs(colours[2] - value) * 1024 + std::abs(colours[0] - colours[1]);
                if (cost >= least) continue;
                least = cost;
                pairs[static_cast<size_t>(value)] = {static_cast<uint8_t>(a), static_cast<uint8_t>(b)};
            }
        }
    }
    return pairs;
}

/// What the error of endpoints depends on when the indices are fixed, for one channel.
struct CodeSums {
    int32_t count[4] = {};   ///< of texels, by code
    int32_t sum[3][4] = {};  ///< of texels' values
    int32_t squares[3] = {};
};

/// The three channels' numbers in one word, so that they are added at once: sums of 16 stay below 2^21 each.
struct PackedTexel {
    static constexpr uint32_t kBits = 21, kMask = (1u << kBits) - 1;

    static uint64_t pack(uint64_t r, uint64_t g, uint64_t b) { return r | g << kBits | b << (2 * kBits); }
    static int32_t channel(uint64_t packed, int c) { return static_cast<int32_t>(packed >> (c * kBits) & kMask); }
};

CodeSums sum_codes(const Bc1Texels& texels, uint32_t indices) {
    uint64_t values[kTexels], squares = 0;
    for (int i = 0; i < kTexels; ++i) {
        const auto value = [&](int c) { return static_cast<uint32_t>(static_cast<int32_t>(texels.channel[c][i])); };
        const uint32_t r = value(0), g = value(1), b = value(2);
        values[i] = PackedTexel::pack(r, g, b);
        squares += PackedTexel::pack(r * r, g * g, b * b);
    }
    uint64_t sum[4] = {};
    CodeSums sums;
    for (int i = 0; i < kTexels; ++i) {
        const uint32_t code = indices >> (2 * i) & 3u;
        sum[code] += values[i];
        ++sums.count[code];
    }
    for (int c = 0; c < 3; ++c) {
        sums.squares[c] = PackedTexel::channel(squares, c);
        for (int code = 0; code < 4; ++code) sums.sum[c][code] = PackedTexel::channel(sum[code], c);
    }
    return sums;
}

/// Error of a pair of endpoints, less the sum of the texels' squares.
int32_t pair_error(const CodeSums& sums, int channel, int32_t a, int32_t b) {
    const uint8_t* colours = pair_colours(channel, a, b);
    int32_t error = 0;
    for (int code = 0; code < 4; ++code)
        error += colours[code] * (sums.count[code] * colours[code] - 2 * sums.sum[channel][code]);
    return error;
}

int32_t nearest_level(float value, int32_t levels) {
    const float scaled = std::clamp(value, 0.0f, 255.0f) * static_cast<float>(levels - 1) * (1.0f / 255.0f);
    return static_cast<int32_t>(scaled + 0.5f);
}

struct ChannelFit {
    int32_t a = 0, b = 0;
    int32_t error = 0;
};

ChannelFit search_pairs(const CodeSums& sums, int channel, float from, float to) {
    const int32_t last = kLevels[channel] - 1;
    const int32_t a = nearest_level(from, last + 1), b = nearest_level(to, last + 1);
    ChannelFit best = {a, b, pair_error(sums, channel, a, b)};
    for (int32_t i = std::max(a - 1, 0); i <= std::min(a + 1, last); ++i) {
        for (int32_t j = std::max(b - 1, 0); j <= std::min(b + 1, last); ++j) {
            const int32_t error = pair_error(sums, channel, i, j);
            if (error < best.error) best = {i, j, error};
        }
    }
    return best;
}

uint32_t exchange_endpoints(uint32_t endpoints) {
    return endpoints << 16 | endpoints >> 16;
}

/// Endpoints for a block whose texels all have one code.
uint32_t one_code_endpoints(const CodeSums& sums, uint32_t code) {
    int32_t mean[3];
    for (int c = 0; c < 3; ++c) mean[c] = (sums.sum[c][code] + kTexels / 2) / kTexels;
    const uint32_t endpoints = bc1_constant_endpoints(mean);
    if (code >= 2) return code == 2 ? endpoints : exchange_endpoints(endpoints);
    uint32_t colour = 0;
    for (int c = 0; c < 3; ++c)
        colour |= static_cast<uint32_t>(nearest_level(static_cast<float>(mean[c]), kLevels[c])) << kShift[c];
    return colour | colour << 16;
}

uint32_t block_error(const Bc1Texels& texels, const ChannelWeights& weights, const Bc1Block& block) {
    float error[4][kTexels];
    bc1_code_errors(texels, weights, block.endpoints, error);
    uint32_t sum = 0;
    for (int i = 0; i < kTexels; ++i)
        sum += static_cast<uint32_t>(static_cast<int32_t>(error[block.indices >> (2 * i) & 3u][i]));
    return sum;
}

}  // namespace

void bc1_palette(uint32_t endpoints, int32_t palette[4][3]) {
    for (int c = 0; c < 3; ++c) {
        const uint8_t* colours = pair_colours(c, static_cast<int32_t>(channel_of(endpoints, c)),
                                              static_cast<int32_t>(channel_of(endpoints >> 16, c)));
        for (int code = 0; code < 4; ++code) palette[code][c] = colours[code];
    }
}

Bc1Texels bc1_texels(const uint8_t rgb[48]) {
    Bc1Texels texels;
    for (int i = 0; i < kTexels; ++i) {
        for (int c = 0; c < 3; ++c) texels.channel[c][i] = rgb[3 * i + c];
    }
    return texels;
}

void bc1_code_errors(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints, float error[4][16]) {
    int32_t palette[4][3];
    bc1_palette(endpoints, palette);
    float weight[3];
    for (int c = 0; c < 3; ++c) weight[c] = static_cast<float>(weights.weight[c]);
    for (int code = 0; code < 4; ++code) {
        float colour[3];
        for (int c = 0; c < 3; ++c) colour[c] = static_cast<float>(palette[code][c]);
        for (int i = 0; i < kTexels; ++i) {
            const float r = texels.channel[0][i] - colour[0];
            const float g = texels.channel[1][i] - colour[1];
            const float b = texels.channel[2][i] - colour[2];
            error[code][i] = r * r * weight[0] + g * g * weight[1] + b * b * weight[2];
        }
    }
}

Bc1Block fit_bc1_indices(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints) {
    Bc1Block block;
    block.endpoints = (endpoints & 0xffffu) < endpoints >> 16 ? exchange_endpoints(endpoints) : endpoints;
    float error[4][kTexels];
    bc1_code_errors(texels, weights, block.endpoints, error);
    int32_t code[kTexels];
    for (int i = 0; i < kTexels; ++i) {
        // Of two pairs the better of each, then the better of both; the lower code wins ties.
        const bool one = error[1][i] < error[0][i];
        const bool three = error[3][i] < error[2][i];
        const float low = one ? error[1][i] : error[0][i];
        const float high = three ? error[3][i] : error[2][i];
        const bool upper = high < low;
        code[i] = upper ? (three ? 3 : 2) : (one ? 1 : 0);
        error[0][i] = upper ? high : low;
    }
    for (int i = 0; i < kTexels; ++i) {
        block.error += static_cast<uint32_t>(static_cast<int32_t>(error[0][i]));
        block.indices |= static_cast<uint32_t>(code[i]) << (2 * i);
    }
    return block;
}

Bc1Block fit_bc1_endpoints(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t indices) {
    const CodeSums sums = sum_codes(texels, indices);
    int32_t aa = 0, ab = 0, bb = 0;
    constexpr int32_t kWeight[4] = {3, 0, 2, 1};  // thirds of c0
    for (int code = 0; code < 4; ++code) {
        const int32_t w = kWeight[code];
        aa += sums.count[code] * w * w;
        ab += sums.count[code] * w * (3 - w);
        bb += sums.count[code] * (3 - w) * (3 - w);
    }
    const int32_t determinant = aa * bb - ab * ab;
    Bc1Block block;
    block.indices = indices;
    if (determinant == 0) {
        block.endpoints = one_code_endpoints(sums, indices & 3u);
        block.error = block_error(texels, weights, block);
        return block;
    }
    const float scale = 3.0f / static_cast<float>(determinant);
    for (int c = 0; c < 3; ++c) {
        const int32_t* sum = sums.sum[c];
        const int32_t a = 3 * sum[0] + 2 * sum[2] + sum[3], b = 3 * sum[1] + sum[2] + 2 * sum[3];
        const ChannelFit fit = search_pairs(sums, c, static_cast<float>(bb * a - ab * b) * scale,
                                            static_cast<float>(aa * b - ab * a) * scale);
        block.endpoints |= static_cast<uint32_t>(fit.a) << kShift[c] | static_cast<uint32_t>(fit.b) << (16 + kShift[c]);
        block.error += static_cast<uint32_t>(fit.error + sums.squares[c]) * weights.weight[c];
    }
    return block;
}

Bc1Block ordered_bc1(const Bc1Block& block) {
    Bc1Block ordered = block;
    if ((block.endpoints & 0xffffu) == block.endpoints >> 16) {
        ordered.indices = 0;
    } else if ((block.endpoints & 0xffffu) < block.endpoints >> 16) {
        ordered.endpoints = exchange_endpoints(block.endpoints);
        ordered.indices = block.indices ^ 0x55555555u;  // 0 <-> 1, 2 <-> 3
    }
    return ordered;
}

uint32_t bc1_constant_endpoints(const int32_t rgb[3]) {
    static const std::array<std::array<ConstantPair, 256>, 3> pairs = {constant_pairs(0), constant_pairs(1),
                                                                       constant_pairs(2)};
    uint32_t endpoints = 0;
    for (int c = 0; c < 3; ++c) {
        const ConstantPair pair = pairs[static_cast<size_t>(c)][static_cast<size_t>(rgb[c])];
        endpoints |= uint32_t{pair.a} << kShift[c] | uint32_t{pair.b} << (16 + kShift[c]);
    }
    return endpoints;
}

}  // namespace citystream::codec::atlas
