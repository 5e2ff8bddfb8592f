// Any words as a patch map: what is accepted decodes, is encoded again without loss, travels, and has a wire form that
// expands to it.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/facade/patch_map.h"
#include "codec/facade/patch_wire.h"
#include "tests/fuzz/layer_words.h"

namespace {

/// Re-encoding large maps would only make the fuzzer slow.
constexpr size_t kMostCells = 1u << 14;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec;
    const std::vector<uint32_t> words = citystream::words_of({data, size});
    const bool accepted = facade::check_patch_map(words).ok();
    const auto grid = facade::decode_patch_map(words);
    if (grid.ok() != accepted) std::abort();
    if (!accepted) return 0;
    bits::RangeEncoder encoder;
    facade::put_patch_wire(words, encoder);
    const std::vector<std::byte> wire = encoder.finish();
    bits::RangeDecoder decoder(wire);
    const auto expanded = facade::get_patch_wire(decoder, 4 * words.size());
    if (!expanded || *expanded != words || !decoder.finish().ok()) std::abort();
    if (grid->labels.size() > kMostCells) return 0;
    const auto again = facade::encode_patch_map(*grid);
    if (again && !(facade::decode_patch_map(*again).value() == *grid)) std::abort();
    return 0;
}
