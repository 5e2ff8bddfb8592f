// Any bytes as the wire form of a patch map: words or an error, in bounded time and memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/facade/patch_map.h"
#include "codec/facade/patch_wire.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec;
    constexpr size_t kResidentBytes = 1u << 14;
    bits::RangeDecoder decoder(std::as_bytes(std::span(data, size)));
    const auto words = facade::get_patch_wire(decoder, kResidentBytes);
    if (words && facade::check_patch_map(*words).ok() != facade::decode_patch_map(*words).ok()) std::abort();
    return 0;
}
