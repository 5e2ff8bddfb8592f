// Any bytes as a packed mesh: what unpacks has the number of words that was said, and packs to what unpacks the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>

#include "codec/mesh/mesh_packing.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    namespace mesh = citystream::codec::mesh;
    uint16_t word_count = 0;
    if (size < sizeof(word_count)) return 0;
    std::memcpy(&word_count, data, sizeof(word_count));
    const auto bytes = std::as_bytes(std::span(data, size).subspan(sizeof(word_count)));
    const auto words = mesh::unpack_mesh(bytes, word_count);
    if (!words) return 0;
    if (words->size() != word_count) std::abort();
    const auto packed = mesh::pack_mesh(*words);
    if (!packed) return 0;
    const auto again = mesh::unpack_mesh(*packed, word_count);
    if (!again || *again != *words) std::abort();
    return 0;
}
