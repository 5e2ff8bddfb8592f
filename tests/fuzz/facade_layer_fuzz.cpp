// Any words as a facade layer: what is accepted names only maps, palettes and charts that exist, and encodes to itself
// again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/facade/facade_layer.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::facade;
    const auto tile = decode_facades(citystream::words_of({data, size}), 5, 4);
    if (!tile) return 0;
    for (const Placement& placement : tile->placements) {
        if (placement.map >= 5 || placement.palette >= tile->palettes.size()) std::abort();
    }
    const auto again = decode_facades(encode_facades(*tile).at(0).words, 5, 4);
    if (!again || !(*again == *tile)) std::abort();
    return 0;
}
