#include "codec/radiance/visibility_smoothing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numbers>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kAllSamples = (1u << kSamplesInTexel) - 1;

/// The samples of each square and what one of them is of a hemisphere.
struct Square {
    std::array<uint32_t, kSamplesInTexel> samples{};
    std::array<double, kSamplesInTexel> shares{};
};

std::vector<Square> squares_of(uint32_t side) {
    const uint32_t across = kSamplesAcross * side;
    std::vector<Square> squares(texel_count(side));
    std::vector<uint32_t> filled(squares.size(), 0);
    for (uint32_t s = 0; s < sample_count(side); ++s) {
        const uint32_t texel = texel_of_sample(side, s);
        squares[texel].samples[filled[texel]] = s;
        squares[texel].shares[filled[texel]++] = cell_solid_angle(across, s) / (2 * std::numbers::pi);
    }
    return squares;
}

/// A bit for each sample of a square.
uint32_t bits_of(std::span<const uint32_t> words, const Square& square) {
    uint32_t bits = 0;
    for (uint32_t i = 0; i < kSamplesInTexel; ++i)
        bits |= (words[square.samples[i] / 32] >> square.samples[i] % 32 & 1) << i;
    return bits;
}

double smooth(std::span<uint32_t> words, std::span<const uint32_t> above, const std::vector<Square>& squares,
              double most_error) {
    double wrong = 0;
    for (const Square& square : squares) {
        if (bits_of(above, square) != kAllSamples) continue;
        const uint32_t seen = bits_of(words, square);
        const uint32_t lone = std::has_single_bit(seen) ? seen : kAllSamples & ~seen;
        if (!std::has_single_bit(lone)) continue;
        const auto which = static_cast<size_t>(std::countr_zero(lone));
        if (wrong + square.shares[which] > most_error) continue;
        wrong += square.shares[which];
        words[square.samples[which] / 32] ^= 1u << square.samples[which] % 32;
    }
    return wrong;
}

}  // namespace

double smooth_visibility(VisibilityTile& tile, double most_error) {
    if (!(most_error > 0)) return 0;
    const std::vector<Square> squares = squares_of(tile.side);
    std::vector<std::vector<uint32_t>> above;
    for (const uint32_t frame : tile.frames) above.push_back(samples_above(unpack_frame(frame), tile.side));
    double worst = 0;
    const size_t words = tile.words_a_receiver();
    for (uint32_t r = 0; r < tile.receivers(); ++r)
        worst = std::max(worst, smooth(std::span(tile.words).subspan(r * words, words), above[tile.frame_of[r]],
                                       squares, most_error));
    return worst;
}

}  // namespace citystream::codec::radiance
