// Any words as local strips: all corners exist, and what was decoded can be coded again.
#include "codec/mesh/local_strips.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/mesh/local_strips_layout.h"
#include "tests/codec/mesh/topology_meshes.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::mesh;
    constexpr uint32_t kMostVertices = 1u << 16;  // what an encoder makes room for, not what a decoder does
    const auto words = citystream::words_of({data, size});
    const auto triangles = decode_local_strips(words);
    if (!triangles) return 0;
    const uint32_t vertices = words[LOCAL_STRIPS_WORD_VERTICES];
    for (const auto& corners : *triangles) {
        if (corners[0] >= vertices || corners[1] >= vertices || corners[2] >= vertices) std::abort();
    }
    if (vertices > kMostVertices) return 0;
    const auto code = encode_local_strips(*triangles, vertices);
    auto again = *decode_local_strips(code->words);
    for (auto& corners : again) {
        for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
    }
    if (canonical(again) != canonical(*triangles)) std::abort();
    return 0;
}
