#include "codec/atlas/chart_content.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace citystream::codec::atlas {

namespace {

// Odd constants with about as many ones as zeros.
constexpr uint64_t kFirst = 0x9e3779b97f4a7c15u, kSecond = 0xd6e8feb86659fd93u;

/// Every bit of the result depends on every bit of the value.
uint64_t mixed(uint64_t value) {
    value = (value ^ value >> 32) * kFirst;
    value = (value ^ value >> 29) * kSecond;
    return value ^ value >> 32;
}

}  // namespace

std::optional<std::array<uint8_t, 3>> flat_colour(std::span<const uint8_t> rgb, uint8_t tolerance) {
    assert(!rgb.empty() && rgb.size() % 3 == 0);
    std::array<int, 3> low = {255, 255, 255}, high = {};
    for (size_t i = 0; i < rgb.size(); i += 3) {
        for (size_t c = 0; c < 3; ++c) {
            low[c] = std::min<int>(low[c], rgb[i + c]);
            high[c] = std::max<int>(high[c], rgb[i + c]);
            if (high[c] - low[c] > 2 * tolerance) return std::nullopt;
        }
    }
    std::array<uint8_t, 3> colour;
    for (size_t c = 0; c < 3; ++c) colour[c] = static_cast<uint8_t>((low[c] + high[c]) / 2);
    return colour;
}

ContentHash content_hash(const BlockChain& chain) {
    uint64_t low = mixed(chain.words.size() + 1), high = mixed(chain.shape[0] | uint64_t{chain.shape[1]} << 32);
    const auto take = [&](uint64_t value) {
        low = std::rotl(low ^ value, 27) * kFirst;
        high = std::rotl(high + value, 31) * kSecond + low;
    };
    size_t i = 0;
    for (; i + 1 < chain.words.size(); i += 2) take(chain.words[i] | uint64_t{chain.words[i + 1]} << 32);
    if (i < chain.words.size()) take(chain.words[i]);
    return {mixed(low ^ std::rotl(high, 17)), mixed(high + kFirst)};
}

}  // namespace citystream::codec::atlas
