// 16-bit floats, and what arrays of 16-bit numbers take on the wire: the same entropy coder for every approximation of
// the radiance layer that bench_radiance looks at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace citystream::bench {

/// IEEE 754 binary16, nearest, ties to even; what is too great becomes the greatest finite one.
uint16_t to_half(float value);
float from_half(uint16_t half);
/// The value that is left of it.
inline float rounded_to_half(float value) {
    return from_half(to_half(value));
}

/// Bytes of a zstd -19 frame of the lower bytes and one of the upper bytes.
uint64_t coded_bytes(std::span<const uint16_t> values);
/// The same of 32-bit numbers, four frames, as differences to the number before.
uint64_t coded_bytes(std::span<const uint32_t> values);

}  // namespace citystream::bench
