// How the fuzz targets of the layers read their input: little-endian words, with the lengths of the steps in front.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace citystream {

/// Whole little-endian words of the bytes; a rest of 1..3 bytes is left out.
inline std::vector<uint32_t> words_of(std::span<const uint8_t> bytes) {
    std::vector<uint32_t> words(bytes.size() / 4);
    for (size_t i = 0; i < words.size(); ++i) {
        const uint8_t* b = &bytes[4 * i];
        words[i] = b[0] | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
    }
    return words;
}

/// One byte: number of steps - 1 (low 4 bits); two bytes a step but the last: its words; then the words. The last step
/// takes the rest, except when bit 7 of the first byte is set: then its length is given too and may be wrong.
struct LayerInput {
    std::vector<uint32_t> step_words, words;

    explicit LayerInput(std::span<const uint8_t> bytes) {
        if (bytes.empty()) return;
        const size_t steps = (bytes[0] & 15u) + 1;
        const size_t given = steps - ((bytes[0] & 128u) != 0 ? 0 : 1);
        const size_t header = 1 + 2 * given;
        if (bytes.size() < header) return;
        uint32_t sum = 0;
        for (size_t s = 0; s < given; ++s) {
            step_words.push_back(bytes[1 + 2 * s] | uint32_t{bytes[2 + 2 * s]} << 8);
            sum += step_words.back();
        }
        words = words_of(bytes.subspan(header));
        if (given < steps) step_words.push_back(static_cast<uint32_t>(words.size()) - sum);
    }
};

}  // namespace citystream
