#include "codec/atlas/wide_loops.h"

#include <cstring>

namespace citystream::codec::atlas {

namespace {

constexpr size_t kLanes = 8;
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

/// The columns from `i` on, `kGroups` groups of lanes, in registers while all rows pass.
template <size_t kGroups>
inline CITYSTREAM_INLINED void sum_columns(const float* const* rows, const float* weights, size_t taps, float* out,
                                           size_t i) {
    Lanes sums[kGroups] = {};
    for (size_t k = 0; k < taps; ++k) {
        const float* row = rows[k] + i;
        for (size_t g = 0; g < kGroups; ++g) {
            Lanes values;
            std::memcpy(&values, row + g * kLanes, sizeof values);
            sums[g] += weights[k] * values;
        }
    }
    std::memcpy(out + i, sums, sizeof sums);
}

constexpr size_t kTile = 4;
using Quad = float __attribute__((vector_size(kTile * sizeof(float))));

void transpose_tile(const float* in, size_t in_stride, float* out, size_t out_stride) {
    Quad a, b, c, d;
    std::memcpy(&a, in, sizeof a);
    std::memcpy(&b, in + in_stride, sizeof b);
    std::memcpy(&c, in + 2 * in_stride, sizeof c);
    std::memcpy(&d, in + 3 * in_stride, sizeof d);
    const Quad ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5), ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Quad cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5), cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const Quad columns[kTile] = {
        __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5), __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7),
        __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5), __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7)};
    for (size_t x = 0; x < kTile; ++x) std::memcpy(out + x * out_stride, &columns[x], sizeof(Quad));
}

}  // namespace

void weighted_sum(const float* const* rows, const float* weights, size_t taps, float* out, size_t count) {
    run_wide([=]() CITYSTREAM_INLINED {
        size_t i = 0;
        for (; i + 8 * kLanes <= count; i += 8 * kLanes) sum_columns<8>(rows, weights, taps, out, i);
        for (; i + 4 * kLanes <= count; i += 4 * kLanes) sum_columns<4>(rows, weights, taps, out, i);
        for (; i + kLanes <= count; i += kLanes) sum_columns<1>(rows, weights, taps, out, i);
        for (; i < count; ++i) {
            float sum = 0;
            for (size_t k = 0; k < taps; ++k) sum += weights[k] * rows[k][i];
            out[i] = sum;
        }
    });
}

void transpose(const float* in, size_t in_stride, size_t width, size_t height, float* out, size_t out_stride) {
    const size_t whole_width = width - width % kTile, whole_height = height - height % kTile;
    for (size_t y = 0; y < whole_height; y += kTile) {
        for (size_t x = 0; x < whole_width; x += kTile)
            transpose_tile(in + y * in_stride + x, in_stride, out + x * out_stride + y, out_stride);
    }
    for (size_t y = 0; y < height; ++y) {
        for (size_t x = y < whole_height ? whole_width : 0; x < width; ++x)
            out[x * out_stride + y] = in[y * in_stride + x];
    }
}

}  // namespace citystream::codec::atlas
