// Any bytes as the payload of a facade map, after two bytes with the words that it is to expand to: what expands passes
// the check, and its own payload expands to it again. A payload that is too long is cut to what was read of it: nearly
// all mutations are, and would not get past the decoder.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/facade/facade_form.h"
#include "codec/facade/facade_wire.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::facade;
    if (size < 2) return 0;
    const size_t resident_bytes = 4 * (data[0] | size_t{data[1]} << 8);
    const auto wire = std::as_bytes(std::span(data, size)).subspan(2);
    auto words = expand_wire(wire, resident_bytes);
    if (!words.ok() && words.error().offset < wire.size())
        words = expand_wire(wire.first(words.error().offset), resident_bytes);
    if (!words.ok()) return 0;
    if (4 * words->size() != resident_bytes || !check_form(*words).ok()) std::abort();
    const auto again = expand_wire(encode_wire(*words), resident_bytes);
    if (!again.ok() || *again != *words) std::abort();
    return 0;
}
