// Systematic damage to a layer's words, for the tests of every codec: all truncations, and every word replaced by
// awkward values.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec {

inline constexpr uint32_t kAwkwardWords[] = {0u,          1u,          2u,          0xffu,       0xffffu,    0x10000u,
                                             0x7fffffffu, 0x80000000u, 0xfffffffeu, 0xffffffffu, 0x20202020u};

/// Words in a buffer of exactly their size, so that a sanitizer sees a read one word past the end.
inline std::vector<uint32_t> exact_copy(std::span<const uint32_t> words) {
    std::vector<uint32_t> copy;
    copy.reserve(words.size());
    copy.assign(words.begin(), words.end());
    return copy;
}

/// Calls visit(words) with every awkward value and every flipped bit at every place; the rest of the words stays as it
/// is.
template <typename Visit>
void for_each_mutation(std::span<const uint32_t> words, Visit visit) {
    std::vector<uint32_t> damaged = exact_copy(words);
    for (size_t i = 0; i < damaged.size(); ++i) {
        const uint32_t kept = damaged[i];
        for (const uint32_t value : kAwkwardWords) {
            damaged[i] = value;
            visit(std::span<const uint32_t>(damaged));
        }
        for (uint32_t bit = 0; bit < 32; ++bit) {
            damaged[i] = kept ^ (1u << bit);
            visit(std::span<const uint32_t>(damaged));
        }
        damaged[i] = kept;
    }
}

}  // namespace citystream::codec
