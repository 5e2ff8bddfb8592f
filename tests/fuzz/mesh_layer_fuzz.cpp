// Any words as a mesh layer: what the view accepts must be readable to the last corner.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const citystream::LayerInput input({data, size});
    const auto tile = citystream::codec::mesh::decode_mesh(input.words, input.step_words, 4);
    if (!tile) return 0;
    for (const uint32_t index : tile->indices) {
        if (index >= tile->vertices.size()) std::abort();
    }
    for (const uint32_t chart : tile->triangle_chart) {
        if (!citystream::codec::is_chart_word(chart, 4)) std::abort();
    }
    return 0;
}
