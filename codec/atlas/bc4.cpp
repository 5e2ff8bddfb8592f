#include "codec/atlas/bc4.h"

#include <algorithm>
#include <cstdlib>

namespace citystream::codec::atlas {

namespace {

constexpr int32_t kTexels = 16;

void bc4_palette(int32_t a0, int32_t a1, int32_t palette[8]) {
    palette[0] = a0;
    palette[1] = a1;
    if (a0 > a1) {
        for (int32_t code = 2; code < 8; ++code) palette[code] = ((8 - code) * a0 + (code - 1) * a1 + 3) / 7;
        return;
    }
    for (int32_t code = 2; code < 6; ++code) palette[code] = ((6 - code) * a0 + (code - 1) * a1 + 2) / 5;
    palette[6] = 0;
    palette[7] = 255;
}

struct ValueFit {
    int32_t a0 = 0, a1 = 0;
    int32_t error = 0;
    uint8_t code[kTexels] = {};
};

ValueFit fit_codes(const uint8_t values[kTexels], int32_t a0, int32_t a1) {
    int32_t palette[8];
    bc4_palette(a0, a1, palette);
    ValueFit fit{a0, a1};
    for (int32_t i = 0; i < kTexels; ++i) {
        int32_t least = 1 << 30;
        for (int32_t code = 0; code < 8; ++code) {
            const int32_t difference = palette[code] - values[i];
            if (difference * difference >= least) continue;
            least = difference * difference;
            fit.code[i] = static_cast<uint8_t>(code);
        }
        fit.error += least;
    }
    return fit;
}

/// Steps either end value up and down, both modes staying what they are, while that lowers the error.
ValueFit step_ends(const uint8_t values[kTexels], ValueFit best) {
    const bool eight = best.a0 > best.a1;
    for (int32_t step = 16; step > 0 && best.error > 0; step /= 2) {
        for (int since = 0, k = 0; since < 4 && best.error > 0; k = (k + 1) % 4, ++since) {
            const int32_t by = k % 2 == 0 ? step : -step;
            const int32_t a0 = std::clamp(best.a0 + (k < 2 ? by : 0), 0, 255);
            const int32_t a1 = std::clamp(best.a1 + (k < 2 ? 0 : by), 0, 255);
            if ((a0 > a1) != eight) continue;
            const ValueFit stepped = fit_codes(values, a0, a1);
            if (stepped.error >= best.error) continue;
            best = stepped;
            since = -1;
        }
    }
    return best;
}

}  // namespace

void encode_bc4_block(const uint8_t values[16], uint32_t out[2]) {
    int32_t low = 255, high = 0, inner_low = 255, inner_high = 0;
    for (int32_t i = 0; i < kTexels; ++i) {
        const int32_t value = values[i];
        low = std::min(low, value);
        high = std::max(high, value);
        if (value == 0 || value == 255) continue;
        inner_low = std::min(inner_low, value);
        inner_high = std::max(inner_high, value);
    }
    if (inner_low > inner_high) inner_low = inner_high = low;
    // Six values from below to above, 0 and 255 apart.
    ValueFit best = step_ends(values, fit_codes(values, inner_low, inner_high));
    if (high > low && best.error > 0) {
        const ValueFit eight = step_ends(values, fit_codes(values, high, low));
        if (eight.error < best.error) best = eight;
    }
    uint64_t bits = static_cast<uint64_t>(best.a0) | static_cast<uint64_t>(best.a1) << 8;
    for (int32_t i = 0; i < kTexels; ++i) bits |= uint64_t{best.code[i]} << (16 + 3 * i);
    out[0] = static_cast<uint32_t>(bits);
    out[1] = static_cast<uint32_t>(bits >> 32);
}

uint8_t decode_bc4_texel(const uint32_t block[2], uint32_t i) {
    const uint64_t bits = block[0] | uint64_t{block[1]} << 32;
    int32_t palette[8];
    bc4_palette(static_cast<int32_t>(bits & 255), static_cast<int32_t>(bits >> 8 & 255), palette);
    return static_cast<uint8_t>(palette[bits >> (16 + 3 * i) & 7]);
}

}  // namespace citystream::codec::atlas
