#include "client/render/map_texels.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace citystream::client {
namespace {

constexpr int kFractionBits = 9, kBias = 15, kMostExponent = 31;
constexpr uint32_t kFractionEnd = 1U << kFractionBits;

/// Of the least power of two above a value, at least -kBias. `value`: 0 or more, below 2^127.
int exponent_above(float value) {
    return std::max(static_cast<int>(std::bit_cast<uint32_t>(value) >> 23) - 126, -kBias);
}

/// Exact, of an exponent that normal numbers have.
float power_of_two(int exponent) {
    return std::bit_cast<float>(static_cast<uint32_t>(exponent + 127) << 23);
}

/// The nearest whole number of 2^exponent.
uint32_t steps_of(float value, int exponent) {
    const double steps = static_cast<double>(value) * static_cast<double>(power_of_two(-exponent));
    return static_cast<uint32_t>(std::floor(steps + 0.5));
}

float greatest_of(const Rgb& colour) {
    return std::max({colour[0], colour[1], colour[2]});
}

}  // namespace

uint32_t pack_shared_exponent(const Rgb& colour) {
    const float greatest = greatest_of(colour);
    int exponent = exponent_above(greatest);
    // Rounded up to the next power of two, the greatest needs the next exponent.
    if (steps_of(greatest, exponent - kFractionBits) == kFractionEnd) ++exponent;
    exponent = std::min(exponent, kMostExponent - kBias);
    uint32_t word = static_cast<uint32_t>(exponent + kBias) << (3 * kFractionBits);
    for (uint32_t c = 0; c < 3; ++c)
        word |= std::min(steps_of(colour[c], exponent - kFractionBits), kFractionEnd - 1) << (kFractionBits * c);
    return word;
}

Rgb unpack_shared_exponent(uint32_t word) {
    const int exponent = static_cast<int>(word >> (3 * kFractionBits)) - kBias - kFractionBits;
    Rgb colour;
    for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t fraction = word >> (kFractionBits * c) & (kFractionEnd - 1);
        colour[c] = std::ldexp(static_cast<float>(fraction), exponent);
    }
    return colour;
}

MapTexels map_texels(const EnvironmentMap& map) {
    float greatest = 0;
    for (const Rgb& texel : map.texels) greatest = std::max(greatest, greatest_of(texel));
    MapTexels result;
    // The greatest comes to lie below 2^kBias; a map darker than 2^-kBias is brought up by 2^(2 kBias).
    const int exponent = exponent_above(greatest) - kBias;
    result.scale = power_of_two(exponent);
    const float inverse = power_of_two(-exponent);
    result.words.reserve(map.texels.size());
    for (const Rgb& texel : map.texels)
        result.words.push_back(pack_shared_exponent({texel[0] * inverse, texel[1] * inverse, texel[2] * inverse}));
    return result;
}

}  // namespace citystream::client
