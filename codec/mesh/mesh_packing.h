// Step 0 of a mesh layer as it travels: the same fields as differences in whole bytes, which zstd takes much better
// than packed bits (a quarter of the bytes on walls). FORMAT.md, "On the wire".
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::mesh {

/// Packs what encode_mesh wrote as step 0. Nothing where `words` is anything else, or so small that it would become
/// larger than most_packed_bytes. O(words).
std::optional<std::vector<std::byte>> pack_mesh(std::span<const uint32_t> words);

/// Whether bytes begin like packed ones.
bool is_packed_mesh(std::span<const std::byte> bytes);

/// The most bytes that may unpack to `words` words.
uint64_t most_packed_bytes(uint64_t words);

/// Words back. Every count is checked against `word_count` (which the caller has bounded) and against the bytes before
/// anything is allocated; the result still needs MeshLayerView::create.
Result<std::vector<uint32_t>> unpack_mesh(std::span<const std::byte> bytes, uint64_t word_count);

}  // namespace citystream::codec::mesh
