// A step of an atlas layer as it travels: its blocks in planes (block_planes.h), which zstd takes better than whole
// blocks; tables as they are. Undone at arrival. FORMAT.md, "On the wire".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::atlas {

/// Packs what encode_atlas wrote as step number `step` of the layer whose step 0 is `step0`. Nothing where the words
/// are anything else. O(words).
std::optional<std::vector<std::byte>> pack_atlas_step(std::span<const uint32_t> step0, uint32_t step,
                                                      std::span<const uint32_t> words);

/// Whether bytes begin like packed ones.
bool is_packed_atlas(std::span<const std::byte> bytes);

/// The most bytes that may unpack to `words` words; all of them are more than the words' own.
uint64_t most_packed_atlas_bytes(uint64_t words);

/// Words back. Every count is checked against `word_count` (which the caller has bounded) and against the bytes before
/// anything is allocated; the result still needs AtlasLayerView::create.
Result<std::vector<uint32_t>> unpack_atlas_step(std::span<const std::byte> bytes, uint64_t word_count);

}  // namespace citystream::codec::atlas
