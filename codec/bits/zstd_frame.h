// One independent zstd frame with content size and content checksum: how every step travels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::bits {

/// Compresses at `level` (1..19) with content size and checksum. Deterministic for one zstd version.
std::vector<std::byte> compress_frame(std::span<const std::byte> raw, int level = 19);

/// Decompresses exactly one frame whose decoded size the directory said beforehand. Fails when the frame claims or
/// yields another size, when the checksum is wrong, when bytes follow the frame. Allocates `decoded_size` and no more.
Result<std::vector<std::byte>> decompress_frame(std::span<const std::byte> frame, size_t decoded_size);

/// The decoded size that a frame's header claims, 0 where it claims none. Nothing else of the frame is looked at.
uint64_t frame_content_size(std::span<const std::byte> frame);

}  // namespace citystream::codec::bits
