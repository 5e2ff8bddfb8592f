#include "codec/step_wire.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>

#include "codec/atlas/atlas_packing.h"
#include "codec/bits/zstd_frame.h"
#include "codec/mesh/mesh_packing.h"

namespace citystream::codec {

static_assert(std::endian::native == std::endian::little, "steps are little-endian words");

namespace {

/// The packed form of a step; nothing where it has none.
std::optional<std::vector<std::byte>> pack(std::span<const uint32_t> step0, uint32_t step,
                                           std::span<const uint32_t> words) {
    if (auto packed = atlas::pack_atlas_step(step0, step, words)) return packed;
    if (step > 0) return std::nullopt;
    auto packed = mesh::pack_mesh(words);
    // What is as long as the words would be taken for them.
    if (packed && packed->size() == words.size_bytes()) return std::nullopt;
    return packed;
}

/// Below this many bytes the names of a packed form may cost more than the form gains: both are tried.
constexpr size_t kSmallStep = 16384;

std::vector<std::byte> encode(std::span<const uint32_t> step0, uint32_t step, std::span<const uint32_t> words,
                              int level) {
    const auto packed = pack(step0, step, words);
    if (!packed) return bits::compress_frame(std::as_bytes(words), level);
    std::vector<std::byte> frame = bits::compress_frame(*packed, level);
    if (words.size_bytes() > kSmallStep) return frame;
    std::vector<std::byte> plain = bits::compress_frame(std::as_bytes(words), level);
    return plain.size() < frame.size() ? plain : frame;
}

uint64_t most_packed_bytes(uint64_t words) {
    return std::max(mesh::most_packed_bytes(words), atlas::most_packed_atlas_bytes(words));
}

}  // namespace

std::vector<std::vector<std::byte>> encode_steps(const LayerSteps& steps, int level) {
    std::vector<std::vector<std::byte>> frames;
    for (uint32_t i = 0; i < steps.size(); ++i) frames.push_back(encode(steps[0].words, i, steps[i].words, level));
    return frames;
}

std::vector<std::byte> encode_step(std::span<const uint32_t> words, int level) {
    return encode(words, 0, words, level);
}

Result<std::vector<uint32_t>> decode_step(std::span<const std::byte> frame, size_t decoded_bytes) {
    const uint64_t content = bits::frame_content_size(frame);
    if (content != decoded_bytes && decoded_bytes % 4 == 0 && content <= most_packed_bytes(decoded_bytes / 4)) {
        const auto packed = bits::decompress_frame(frame, static_cast<size_t>(content));
        if (!packed) return packed.error();
        if (mesh::is_packed_mesh(*packed)) return mesh::unpack_mesh(*packed, decoded_bytes / 4);
        if (atlas::is_packed_atlas(*packed)) return atlas::unpack_atlas_step(*packed, decoded_bytes / 4);
    }
    const auto raw = bits::decompress_frame(frame, decoded_bytes);
    if (!raw) return raw.error();
    std::vector<uint32_t> words(raw->size() / 4);
    std::memcpy(words.data(), raw->data(), words.size() * 4);
    return words;
}

}  // namespace citystream::codec
