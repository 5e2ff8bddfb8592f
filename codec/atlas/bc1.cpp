#include "codec/atlas/bc1.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr int kRefinements = 3;

int expand5(uint32_t value) {
    return static_cast<int>(value << 3 | value >> 2);
}
int expand6(uint32_t value) {
    return static_cast<int>(value << 2 | value >> 4);
}

void expand565(uint32_t colour, int rgb[3]) {
    rgb[0] = expand5(colour >> 11 & 31u);
    rgb[1] = expand6(colour >> 5 & 63u);
    rgb[2] = expand5(colour & 31u);
}

/// Nearest integer of a number that is not negative.
int32_t rounded(float value) {
    return static_cast<int32_t>(value + 0.5f);  // NOLINT(bugprone-incorrect-roundings): lround takes a call a texel
}

/// Nearest 5- or 6-bit value of a channel 0..255 (nearest after expansion, which rounding x * 31 / 255 gives).
uint32_t quantise(float value, float levels) {
    return static_cast<uint32_t>(rounded(std::clamp(value, 0.0f, 255.0f) * levels / 255.0f));
}

uint32_t quantise565(const float rgb[3]) {
    return quantise(rgb[0], 31) << 11 | quantise(rgb[1], 63) << 5 | quantise(rgb[2], 31);
}

struct Block {
    uint32_t c0 = 0, c1 = 0;
    uint32_t indices = 0;
    int error = 0;
};

/// The palette in the format's integers: index 0, 1 the endpoints, 2, 3 the thirds.
void palette_of(uint32_t c0, uint32_t c1, int palette[4][3]) {
    expand565(c0, palette[0]);
    expand565(c1, palette[1]);
    for (int i = 0; i < 3; ++i) {
        palette[2][i] = (2 * palette[0][i] + palette[1][i] + 1) / 3;
        palette[3][i] = (palette[0][i] + 2 * palette[1][i] + 1) / 3;
    }
}

/// Channels apart and in float (every value below is a whole number under 2^24, hence exact), so that the compiler can
/// work on several texels at once.
struct Texels {
    float channel[3][kTexels];
};

/// The best indices for two endpoints, which it orders to the four-colour mode.
Block fit_indices(const Texels& texels, uint32_t c0, uint32_t c1) {
    Block block;
    block.c0 = std::max(c0, c1);
    block.c1 = std::min(c0, c1);
    int palette[4][3];
    palette_of(block.c0, block.c1, palette);
    float best[kTexels];
    int index[kTexels];
    for (int entry = 0; entry < 4; ++entry) {
        const float red = static_cast<float>(palette[entry][0]);
        const float green = static_cast<float>(palette[entry][1]);
        const float blue = static_cast<float>(palette[entry][2]);
        float distance[kTexels];
        for (int i = 0; i < kTexels; ++i) {
            const float r = texels.channel[0][i] - red;
            const float g = texels.channel[1][i] - green;
            const float b = texels.channel[2][i] - blue;
            distance[i] = r * r + g * g + b * b;
        }
        for (int i = 0; i < kTexels; ++i) {
            const bool better = entry == 0 || distance[i] < best[i];
            best[i] = better ? distance[i] : best[i];
            index[i] = better ? entry : index[i];
        }
    }
    // Equal endpoints make four equal entries, and strict comparison has left every index at 0 then.
    for (int i = 0; i < kTexels; ++i) {
        block.error += static_cast<int>(best[i]);
        block.indices |= static_cast<uint32_t>(index[i]) << (2 * i);
    }
    return block;
}

struct ConstantPair {
    uint8_t a = 0, b = 0;  ///< quantised endpoints whose third (2a + b + 1) / 3 is nearest to the channel value
};

template <size_t kLevels>
std::array<ConstantPair, 256> constant_pairs(int (*expand)(uint32_t)) {
    std::array<ConstantPair, 256> pairs;
    for (int value = 0; value < 256; ++value) {
        int best = 1 << 30;
        for (uint32_t a = 0; a < kLevels; ++a) {
            for (uint32_t b = 0; b < kLevels; ++b) {
                const int miss = std::abs((2 * expand(a) + expand(b) + 1) / 3 - value);
                // Among equally near pairs the closest together: least harm where a sampler blends differently.
                const int cost = miss * 1024 + std::abs(expand(a) - expand(b));
                if (cost < best) {
                    best = cost;
                    pairs[static_cast<size_t>(value)] = {static_cast<uint8_t>(a), static_cast<uint8_t>(b)};
                }
            }
        }
    }
    return pairs;
}

/// The nearest block of one colour.
std::pair<uint32_t, uint32_t> constant_endpoints(const int rgb[3]) {
    static const std::array<ConstantPair, 256> five = constant_pairs<32>(expand5);
    static const std::array<ConstantPair, 256> six = constant_pairs<64>(expand6);
    const ConstantPair r = five[static_cast<size_t>(rgb[0])];
    const ConstantPair g = six[static_cast<size_t>(rgb[1])];
    const ConstantPair b = five[static_cast<size_t>(rgb[2])];
    return {uint32_t{r.a} << 11 | uint32_t{g.a} << 5 | b.a, uint32_t{r.b} << 11 | uint32_t{g.b} << 5 | b.b};
}

/// Direction of the largest spread of the colours (power iteration on the covariance), scaled to largest component 1.
void principal_axis(const Texels& texels, const float mean[3], float axis[3]) {
    float covariance[3][3] = {};
    for (int i = 0; i < kTexels; ++i) {
        float d[3];
        for (int c = 0; c < 3; ++c) d[c] = texels.channel[c][i] - mean[c];
        for (int c = 0; c < 3; ++c) {
            for (int e = c; e < 3; ++e) covariance[c][e] += d[c] * d[e];
        }
    }
    for (int c = 0; c < 3; ++c) {
        for (int e = 0; e < c; ++e) covariance[c][e] = covariance[e][c];
    }
    // The row of the channel with the largest variance cannot be orthogonal to the wanted axis.
    int start = 0;
    for (int c = 1; c < 3; ++c) {
        if (covariance[c][c] > covariance[start][start]) start = c;
    }
    for (int c = 0; c < 3; ++c) axis[c] = covariance[start][c];
    for (int round = 0; round < 6; ++round) {
        float next[3];
        float largest = 0;
        for (int c = 0; c < 3; ++c) {
            next[c] = covariance[c][0] * axis[0] + covariance[c][1] * axis[1] + covariance[c][2] * axis[2];
            largest = std::max(largest, std::abs(next[c]));
        }
        if (largest == 0) return;
        for (int c = 0; c < 3; ++c) axis[c] = next[c] / largest;
    }
}

/// The extreme colours along the principal axis.
std::pair<uint32_t, uint32_t> axis_endpoints(const Texels& texels, const float mean[3]) {
    float axis[3];
    principal_axis(texels, mean, axis);
    const float length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    if (!(length2 > 0)) return {quantise565(mean), quantise565(mean)};
    float low = 0;
    float high = 0;
    for (int i = 0; i < kTexels; ++i) {
        float along = 0;
        for (int c = 0; c < 3; ++c) along += (texels.channel[c][i] - mean[c]) * axis[c];
        low = std::min(low, along);
        high = std::max(high, along);
    }
    float from[3];
    float to[3];
    for (int c = 0; c < 3; ++c) {
        from[c] = mean[c] + axis[c] * (high / length2);
        to[c] = mean[c] + axis[c] * (low / length2);
    }
    return {quantise565(from), quantise565(to)};
}

/// Endpoints that fit the texels best for fixed indices (least squares). False when the indices do not determine them.
bool refit_endpoints(const Texels& texels, uint32_t indices, std::pair<uint32_t, uint32_t>& endpoints) {
    constexpr int kWeight[4] = {3, 0, 2, 1};  // thirds of c0 in each palette entry
    int aa = 0;
    int ab = 0;
    int bb = 0;
    float at[3] = {};
    float bt[3] = {};
    for (int i = 0; i < kTexels; ++i) {
        const int a = kWeight[indices >> (2 * i) & 3u];
        const int b = 3 - a;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        for (int c = 0; c < 3; ++c) {
            at[c] += static_cast<float>(a) * texels.channel[c][i];
            bt[c] += static_cast<float>(b) * texels.channel[c][i];
        }
    }
    const int determinant = aa * bb - ab * ab;
    if (determinant == 0) return false;
    float from[3];
    float to[3];
    const float scale = 3.0f / static_cast<float>(determinant);
    for (int c = 0; c < 3; ++c) {
        from[c] = (static_cast<float>(bb) * at[c] - static_cast<float>(ab) * bt[c]) * scale;
        to[c] = (static_cast<float>(aa) * bt[c] - static_cast<float>(ab) * at[c]) * scale;
    }
    endpoints = {quantise565(from), quantise565(to)};
    return true;
}

Block best_block(const Texels& texels) {
    float mean[3];
    int rounded_mean[3];
    bool equal = true;
    for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int i = 0; i < kTexels; ++i) {
            sum += texels.channel[c][i];
            equal = equal && texels.channel[c][i] == texels.channel[c][0];
        }
        mean[c] = sum / kTexels;
        rounded_mean[c] = rounded(mean[c]);
    }
    const auto constant = constant_endpoints(rounded_mean);
    if (equal) return fit_indices(texels, constant.first, constant.second);

    auto endpoints = axis_endpoints(texels, mean);
    Block best = fit_indices(texels, endpoints.first, endpoints.second);
    for (int round = 0; round < kRefinements && best.error > 0; ++round) {
        if (!refit_endpoints(texels, best.indices, endpoints)) break;
        const Block refined = fit_indices(texels, endpoints.first, endpoints.second);
        if (refined.error >= best.error) break;
        best = refined;
    }
    // Nearly equal texels: the thirds around the mean can be finer than any pair of endpoints on the 565 grid.
    if (best.error < kTexels * 48) {
        const Block flat = fit_indices(texels, constant.first, constant.second);
        if (flat.error < best.error) best = flat;
    }
    return best;
}

}  // namespace

void encode_bc1_block(const uint8_t rgb[48], uint32_t out[2]) {
    Texels texels;
    for (int i = 0; i < kTexels; ++i) {
        for (int c = 0; c < 3; ++c) texels.channel[c][i] = rgb[3 * i + c];
    }
    const Block block = best_block(texels);
    out[0] = block.c0 | block.c1 << 16;
    out[1] = block.indices;
}

void decode_bc1_texel(const uint32_t block[2], uint32_t i, uint8_t rgb[3]) {
    int palette[4][3];
    palette_of(block[0] & 0xffffu, block[0] >> 16, palette);
    const int* colour = palette[block[1] >> (2 * i) & 3u];
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<uint8_t>(colour[c]);
}

}  // namespace citystream::codec::atlas
