// What bench_topology compares the strip codes with: packed index codecs of others, and variants of the paper's code
// that it names and rejects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace citystream::bench {

using TriangleList = std::vector<std::array<uint32_t, 3>>;

/// A codec for topology alone: what travels, and back. The triangles may come in another order, with other numbers for
/// the vertices.
struct TopologyPeer {
    std::string name;
    std::function<std::vector<std::byte>(const TriangleList&, uint32_t vertices)> encode;
    std::function<bool(std::span<const std::byte>, TriangleList&)> decode;
};

/// Ours as it travels (strip code, zstd -19) first; then meshoptimizer's index codec with zstd -19, Draco's Edgebreaker
/// (-cl 10; its positions are all the same point and cost next to nothing) and plain 32-bit indices with zstd -19.
std::vector<TopologyPeer> topology_peers();

/// Resident bytes of meshoptimizer's meshlets (64 vertices, 124 triangles): descriptors, vertex numbers, byte triples.
uint64_t meshlet_bytes(const TriangleList& triangles, uint32_t vertices);

/// Bits of the explicit references of a strip code in other word-aligned codes, each in the fewest words.
struct WordCodeBits {
    uint64_t simple9 = 0, simple9_greedy = 0;
    uint64_t separate_selectors = 0;  ///< 32-bit words, their 4-bit selectors in an array of their own
    uint64_t words_of_64 = 0;         ///< Simple-8b
    uint64_t fixed_width = 0;         ///< the references themselves
};
WordCodeBits word_code_bits(std::span<const uint32_t> strip_words);

/// Bits that a strip code in restart mode takes when every `chunk` triangles begin anew, for a decoder with a thread a
/// chunk.
uint64_t chunked_bits(const TriangleList& triangles, uint32_t vertices, uint32_t chunk);

}  // namespace citystream::bench
