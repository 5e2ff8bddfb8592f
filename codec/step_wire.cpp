#include "codec/step_wire.h"

#include <bit>
#include <cstring>

#include "codec/atlas/atlas_packing.h"
#include "codec/bits/zstd_frame.h"

namespace citystream::codec {

static_assert(std::endian::native == std::endian::little, "steps are little-endian words");

namespace {

/// Below this many bytes the names of a packed form may cost more than the form gains: both are tried.
constexpr size_t kSmallStep = 16384;

std::vector<std::byte> encode(std::span<const uint32_t> step0, uint32_t step, std::span<const uint32_t> words,
                              int level) {
    const auto packed = atlas::pack_atlas_step(step0, step, words);
    if (!packed) return bits::compress_frame(std::as_bytes(words), level);
    std::vector<std::byte> frame = bits::compress_frame(*packed, level);
    if (words.size_bytes() > kSmallStep) return frame;
    std::vector<std::byte> plain = bits::compress_frame(std::as_bytes(words), level);
    return plain.size() < frame.size() ? plain : frame;
}

}  // namespace

std::vector<std::vector<std::byte>> encode_steps(const LayerSteps& steps, int level) {
    std::vector<std::vector<std::byte>> frames;
    for (uint32_t i = 0; i < steps.size(); ++i) frames.push_back(encode(steps[0].words, i, steps[i].words, level));
    return frames;
}

Result<std::vector<uint32_t>> decode_step(std::span<const std::byte> frame, size_t decoded_bytes) {
    const uint64_t content = bits::frame_content_size(frame);
    if (content != decoded_bytes && decoded_bytes % 4 == 0 &&
        content <= atlas::most_packed_atlas_bytes(decoded_bytes / 4)) {
        const auto packed = bits::decompress_frame(frame, static_cast<size_t>(content));
        if (!packed) return packed.error();
        if (atlas::is_packed_atlas(*packed)) return atlas::unpack_atlas_step(*packed, decoded_bytes / 4);
    }
    const auto raw = bits::decompress_frame(frame, decoded_bytes);
    if (!raw) return raw.error();
    std::vector<uint32_t> words(raw->size() / 4);
    std::memcpy(words.data(), raw->data(), words.size() * 4);
    return words;
}

}  // namespace citystream::codec
