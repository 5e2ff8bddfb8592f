#include "codec/step_wire.h"

#include <bit>
#include <cstring>

#include "codec/bits/zstd_frame.h"
#include "codec/mesh/mesh_packing.h"

namespace citystream::codec {

static_assert(std::endian::native == std::endian::little, "steps are little-endian words");

std::vector<std::byte> encode_step(std::span<const uint32_t> words, int level) {
    const auto packed = mesh::pack_mesh(words);
    if (!packed || packed->size() == words.size_bytes()) return bits::compress_frame(std::as_bytes(words), level);
    return bits::compress_frame(*packed, level);
}

Result<std::vector<uint32_t>> decode_step(std::span<const std::byte> frame, size_t decoded_bytes) {
    const uint64_t content = bits::frame_content_size(frame);
    if (content != decoded_bytes && decoded_bytes % 4 == 0 && content <= mesh::most_packed_bytes(decoded_bytes / 4)) {
        const auto packed = bits::decompress_frame(frame, static_cast<size_t>(content));
        if (!packed) return packed.error();
        if (mesh::is_packed_mesh(*packed)) return mesh::unpack_mesh(*packed, decoded_bytes / 4);
    }
    const auto raw = bits::decompress_frame(frame, decoded_bytes);
    if (!raw) return raw.error();
    std::vector<uint32_t> words(raw->size() / 4);
    std::memcpy(words.data(), raw->data(), words.size() * 4);
    return words;
}

}  // namespace citystream::codec
