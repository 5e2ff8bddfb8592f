// Simple-9 word-aligned code (Anh and Moffat 2005; Meyer 2012, section 5.6; the notes' T7): a 32-bit word holds a
// selector in bits 0..3 and as many codes of equal width as fit into the other 28 bits, least significant first. A word
// can be read without those before it, which is what a parallel decoder needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::bits {

inline constexpr uint32_t kSimple9Selectors = 9;
inline constexpr std::array<uint32_t, kSimple9Selectors> kSimple9Widths = {1, 2, 3, 4, 5, 7, 9, 14, 28};
inline constexpr std::array<uint32_t, kSimple9Selectors> kSimple9Counts = {28, 14, 9, 7, 5, 4, 3, 2, 1};
inline constexpr uint32_t kSimple9Most = (1u << 28) - 1;  ///< greatest code

/// The fewest words that hold the values in order (the greedy choice of the paper takes up to some per cent more); the
/// last word is padded with zeros. nullopt when a value is above kSimple9Most. Linear time, 5 bytes a value of memory.
std::optional<std::vector<uint32_t>> pack_simple9(std::span<const uint32_t> values);

/// Codes in one word, 0 for the selectors 9..15, which nothing writes.
constexpr uint32_t simple9_count(uint32_t word) {
    return (word & 15) < kSimple9Selectors ? kSimple9Counts[word & 15] : 0;
}

/// Code `place` (below simple9_count) of a word.
constexpr uint32_t simple9_code(uint32_t word, uint32_t place) {
    const uint32_t width = kSimple9Widths[word & 15];
    return word >> (4 + place * width) & ((1u << width) - 1);
}

/// For untrusted words: whether they hold exactly `count` codes, that is, all selectors exist, only the last word has
/// codes to spare and those, like unused bits, are 0.
Status check_simple9(std::span<const uint32_t> words, uint64_t count);

/// The first `count` codes. Precondition: check_simple9 accepts them.
std::vector<uint32_t> unpack_simple9(std::span<const uint32_t> words, size_t count);

}  // namespace citystream::codec::bits
