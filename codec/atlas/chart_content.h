// What charts hold, so that nothing is stored twice: charts of one colour, and charts with equal blocks.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace citystream::codec::atlas {

/// The colour of an image (RGB, 3 bytes a texel, at least one) whose channels each stay within `tolerance` of it;
/// nothing for any other. Such a chart is one texel: one block at every mip.
std::optional<std::array<uint8_t, 3>> flat_colour(std::span<const uint8_t> rgb, uint8_t tolerance = 0);

/// 128 bits that differ for different content but for chance (not against an adversary). The same on every machine; for
/// comparing charts of tiles that are not in memory together.
struct ContentHash {
    uint64_t low = 0, high = 0;
    friend auto operator<=>(const ContentHash&, const ContentHash&) = default;
};

/// All blocks of a chart, mips in any fixed order, and what else must be equal (size, kind, flags) as words of `shape`.
struct BlockChain {
    std::array<uint32_t, 2> shape = {};
    std::span<const uint32_t> words;
};

ContentHash content_hash(const BlockChain& chain);

}  // namespace citystream::codec::atlas
