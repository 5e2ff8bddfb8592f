#include "codec/radiance/visibility_bits.h"

#include <algorithm>

namespace citystream::codec::radiance {

void VisibilityTile::add_receiver(uint32_t frame_code) {
    const auto known = std::find(frames.rbegin(), frames.rend(), frame_code);
    if (known == frames.rend()) {
        frame_of.push_back(static_cast<uint32_t>(frames.size()));
        frames.push_back(frame_code);
    } else {
        frame_of.push_back(static_cast<uint32_t>(frames.rend() - known) - 1);
    }
    words.resize(size_t{receivers()} * words_a_receiver(), 0);
}

bool VisibilityTile::sees(uint32_t receiver, uint32_t sample) const {
    return (of(receiver)[sample / 32] >> sample % 32 & 1) != 0;
}

void VisibilityTile::set(uint32_t receiver, uint32_t sample) {
    words[size_t{receiver} * words_a_receiver() + sample / 32] |= 1u << sample % 32;
}

std::span<const uint32_t> VisibilityTile::of(uint32_t receiver) const {
    return std::span(words).subspan(size_t{receiver} * words_a_receiver(), words_a_receiver());
}

std::vector<uint32_t> samples_above(const Frame& frame, uint32_t side) {
    std::vector<uint32_t> words((sample_count(side) + 31) / 32, 0);
    const GridDirection& normal = frame.axes[2];
    const uint32_t across = kSamplesAcross * side;
    uint32_t s = 0;
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        const FaceProduct height = face_product({normal[0], normal[1], normal[2]}, across, face);
        for (uint32_t row = 0; row < across; ++row) {
            int64_t here = height.at(0, row);
            for (uint32_t column = 0; column < across; ++column, ++s, here += height.right)
                words[s / 32] |= (here > 0 ? 1u : 0u) << s % 32;
        }
    }
    return words;
}

void clear_below_planes(VisibilityTile& tile) {
    std::vector<std::vector<uint32_t>> above;
    for (const uint32_t code : tile.frames) above.push_back(samples_above(unpack_frame(code), tile.side));
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        const auto& mask = above[tile.frame_of[r]];
        for (size_t w = 0; w < mask.size(); ++w) tile.words[r * mask.size() + w] &= mask[w];
    }
}

}  // namespace citystream::codec::radiance
