#include "tests/bench/coded_halves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "codec/bits/zstd_frame.h"

namespace citystream::bench {

namespace {

constexpr float kGreatestHalf = 65504;
constexpr int kMantissaBits = 10, kLeastExponent = -14;

template <typename Number>
uint64_t coded_planes(std::span<const Number> values) {
    uint64_t bytes = 0;
    std::vector<std::byte> plane(values.size());
    for (size_t shift = 0; shift < 8 * sizeof(Number); shift += 8) {
        std::transform(values.begin(), values.end(), plane.begin(),
                       [shift](Number v) { return static_cast<std::byte>(v >> shift & 0xff); });
        bytes += codec::bits::compress_frame(plane).size();
    }
    return bytes;
}

}  // namespace

uint16_t to_half(float value) {
    const auto sign = static_cast<uint16_t>(std::signbit(value) ? 0x8000 : 0);
    const float size = std::min(std::abs(value), kGreatestHalf);
    int exponent = 0;
    std::frexp(size, &exponent);
    exponent = size > 0 ? std::max(exponent - 1, kLeastExponent) : kLeastExponent;
    // In units of the last place; a mantissa that rounds up to the next power of two carries into the exponent.
    const auto units = static_cast<uint32_t>(std::nearbyint(std::ldexp(size, kMantissaBits - exponent)));
    return static_cast<uint16_t>(sign | ((static_cast<uint32_t>(exponent - kLeastExponent) << kMantissaBits) + units));
}

float from_half(uint16_t half) {
    const int exponent = half >> kMantissaBits & 0x1f;
    const int mantissa = half & 0x3ff;
    const float size =
        exponent == 0 ? std::ldexp(static_cast<float>(mantissa), kLeastExponent - kMantissaBits)
                      : std::ldexp(static_cast<float>(1024 + mantissa), kLeastExponent - 1 + exponent - kMantissaBits);
    return (half & 0x8000) != 0 ? -size : size;
}

uint64_t coded_bytes(std::span<const uint16_t> values) {
    return coded_planes(values);
}

uint64_t coded_bytes(std::span<const uint32_t> values) {
    std::vector<uint32_t> steps(values.begin(), values.end());
    for (size_t i = steps.size(); i-- > 1;) steps[i] -= steps[i - 1];
    return coded_planes(std::span<const uint32_t>(steps));
}

}  // namespace citystream::bench
