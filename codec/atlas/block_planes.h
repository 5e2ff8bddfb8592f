// Blocks in planes for the way over the wire: the first words of all blocks, then the second words, and so on. zstd
// makes that smaller than whole blocks, since a BC1 block's endpoints and its index word each recur more often than the
// two of them together (about 7 % less, with nothing lost). Undone at arrival: what is resident stays plain blocks.
#pragma once

#include <cstdint>
#include <span>

namespace citystream::codec::atlas {

/// planes[plane * blocks + block] = words[block * block_words + plane]. block_words >= 1 (BC1, BC4: 2; BC3: 4); the
/// sizes are equal and a multiple of it; the two do not overlap.
void split_block_planes(std::span<const uint32_t> words, uint32_t block_words, std::span<uint32_t> planes);

/// The way back. Any words: only their order changes.
void join_block_planes(std::span<const uint32_t> planes, uint32_t block_words, std::span<uint32_t> words);

}  // namespace citystream::codec::atlas
