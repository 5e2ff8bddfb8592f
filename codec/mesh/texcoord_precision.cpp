#include "codec/mesh/texcoord_precision.h"

#include <algorithm>
#include <bit>

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kRepeatBits = 16;

uint32_t log2_up(uint32_t texels) {
    return static_cast<uint32_t>(std::bit_width(std::max(texels, 1u) - 1));
}

}  // namespace

uint32_t texcoord_bits(uint32_t texels, uint32_t mip, uint32_t fraction_bits) {
    const uint32_t size = log2_up(texels);
    return std::min(size - std::min(size, mip) + fraction_bits, kRepeatBits);
}

uint32_t texcoord_level(const TexcoordWords& words, uint32_t texels, uint32_t mip, uint32_t fraction_bits) {
    const uint32_t dropped = kRepeatBits - texcoord_bits(texels, mip, fraction_bits);
    return words.shape.full_bits - std::min(words.shape.full_bits, dropped);
}

TexcoordWords texcoord_words(std::span<const std::array<int32_t, 2>> coordinates, uint32_t width, uint32_t height) {
    TexcoordWords result;
    const uint32_t longer = std::max(log2_up(width), log2_up(height));
    result.shift = {std::min(longer - log2_up(width), kRepeatBits), std::min(longer - log2_up(height), kRepeatBits)};
    result.shape.vertices = static_cast<uint32_t>(coordinates.size());
    result.shape.components = 2;
    std::array<uint32_t, 2> bits{};
    for (size_t c = 0; c < 2; ++c) {
        int32_t low = coordinates.empty() ? 0 : coordinates[0][c], high = low;
        for (const auto& place : coordinates) {
            low = std::min(low, place[c]);
            high = std::max(high, place[c]);
        }
        result.base[c] = low;
        const uint32_t span = static_cast<uint32_t>(high) - static_cast<uint32_t>(low);
        bits[c] = static_cast<uint32_t>(std::bit_width(span >> result.shift[c]));
    }
    result.shape.full_bits = std::max({bits[0], bits[1], 1u});
    for (size_t c = 0; c < 2; ++c) result.shape.leading[c] = result.shape.full_bits - bits[c];
    for (const auto& place : coordinates) {
        for (size_t c = 0; c < 2; ++c) {
            const uint32_t from_base = static_cast<uint32_t>(place[c]) - static_cast<uint32_t>(result.base[c]);
            result.words.push_back(from_base >> result.shift[c]);
        }
    }
    return result;
}

std::array<int32_t, 2> TexcoordWords::coordinate(const std::array<uint32_t, 2>& fetched, uint32_t level) const {
    std::array<int32_t, 2> place{};
    for (size_t c = 0; c < 2; ++c) {
        // No more is open than the component spans.
        const uint32_t open = std::min(shape.full_bits - level, shape.full_bits - shape.leading[c]) + shift[c];
        place[c] =
            static_cast<int32_t>(static_cast<uint32_t>(base[c]) + (fetched[c] << shift[c]) + ((1u << open) >> 1));
    }
    return place;
}

}  // namespace citystream::codec::mesh
