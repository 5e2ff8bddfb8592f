// Loops over floats that run 8 wide where the processor has AVX2, with the same results bit for bit as without: every
// element goes through the same IEEE operations in the same order. And the transcendental functions that such loops
// need, made of those operations only, so that they do not depend on the C library.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace citystream::codec::atlas {

/// For functions and lambdas that must become part of the loop that calls them.
#define CITYSTREAM_INLINED __attribute__((always_inline))

/// Before a loop whose iterations do not touch each other's elements: GCC takes that from here; Clang checks it at run
/// time.
#if defined(__clang__)
#define CITYSTREAM_INDEPENDENT
#else
#define CITYSTREAM_INDEPENDENT _Pragma("GCC ivdep")
#endif

#if defined(__x86_64__)
template <typename Body>
__attribute__((target("avx2"))) void run_with_avx2(const Body& body) {
    body();
}
#endif

/// Calls `body` (a lambda marked CITYSTREAM_INLINED, without arguments) once.
template <typename Body>
void run_wide(const Body& body) {
#if defined(__x86_64__)
    static const bool has_avx2 = __builtin_cpu_supports("avx2");
    if (has_avx2) return run_with_avx2(body);
#endif
    body();
}

/// Within 1e-6 of log2 (absolute) for normal x in 2^-10 .. 2^10, within two ulp of it otherwise; about -127 for 0.
inline CITYSTREAM_INLINED float fast_log2(float x) {
    // x = 2^e m with m in [sqrt(1/2), sqrt(2)), then the series of the inverse hyperbolic tangent.
    constexpr int32_t kHalfRoot = 0x3f3504f3;
    const auto bits = std::bit_cast<int32_t>(x);
    const int32_t e = (bits - kHalfRoot) >> 23;
    const float m = std::bit_cast<float>(static_cast<int32_t>(bits - (e << 23)));
    const float s = (m - 1) / (m + 1), s2 = s * s;
    const float series = s * (1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7))));
    return static_cast<float>(e) + 2.88539008f * series;
}

/// Relative error below 3e-7 for -126 <= y < 127; smaller y count as -126.
inline CITYSTREAM_INLINED float fast_exp2(float y) {
    const float at_least = y < -126.0f ? -126.0f : y;
    const auto n = static_cast<int32_t>(at_least + 127.5f);  // biased exponent of the nearest power of two
    const float f = (at_least - static_cast<float>(n - 127)) * 0.693147181f;
    const float series =
        1 + f * (1 + f * (1.0f / 2 + f * (1.0f / 6 + f * (1.0f / 24 + f * (1.0f / 120 + f * (1.0f / 720))))));
    return series * std::bit_cast<float>(n << 23);
}

/// x^y for x >= 0; about 1e-38^y for x = 0.
inline CITYSTREAM_INLINED float fast_pow(float x, float y) {
    return fast_exp2(y * fast_log2(x));
}

/// Rows are added up with weights: out[i] = sum over k of weights[k] * rows[k][i], k ascending, for i < count. `out`
/// must not overlap a row. What every separable filter of this folder is made of.
void weighted_sum(const float* const* rows, const float* weights, size_t taps, float* out, size_t count);

/// out[x * out_stride + y] = in[y * in_stride + x] for x < width, y < height. No overlap.
void transpose(const float* in, size_t in_stride, size_t width, size_t height, float* out, size_t out_stride);

}  // namespace citystream::codec::atlas
