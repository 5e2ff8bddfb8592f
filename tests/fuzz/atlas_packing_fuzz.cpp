// Any bytes as a packed atlas step: what unpacks has the number of words that was said, and packs to what unpacks the
// same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "codec/atlas/atlas_packing.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    namespace atlas = citystream::codec::atlas;
    uint16_t word_count = 0;
    if (size < sizeof(word_count)) return 0;
    std::memcpy(&word_count, data, sizeof(word_count));
    const auto bytes = std::as_bytes(std::span(data, size).subspan(sizeof(word_count)));
    const auto words = atlas::unpack_atlas_step(bytes, word_count);
    if (!words) return 0;
    if (words->size() != word_count) std::abort();
    for (uint32_t step = 0; step < 3; ++step) {
        const auto packed = atlas::pack_atlas_step(*words, step, *words);
        if (!packed) continue;
        const auto again = atlas::unpack_atlas_step(*packed, word_count);
        if (!again || *again != *words) std::abort();
    }
    return 0;
}
