#include "codec/atlas/bc1_candidates.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr size_t kTexels = 16, kLanes = 8;

// A number of each of eight candidates. Only passed by reference: how vectors are passed by value depends on the
// processor.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using LaneInts = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));

/// A channel of c0 in 8 bits, of one word or of several.
template <typename Words>
inline CITYSTREAM_INLINED void expand_channel(const Words& endpoints, int channel, Words& value) {
    if (channel == 1) {
        value = (endpoints >> 3 & 0xfc) | (endpoints >> 9 & 3);
    } else if (channel == 0) {
        value = (endpoints >> 8 & 0xf8) | (endpoints >> 13 & 7);
    } else {
        value = (endpoints << 3 & 0xf8) | (endpoints >> 2 & 7);
    }
}

/// Extremes and sums of a block's channels.
struct BlockRange {
    int32_t low[3], high[3], sum[3], weight[3];

    BlockRange(const Bc1Texels& texels, const ChannelWeights& weights) {
        for (int c = 0; c < 3; ++c) {
            low[c] = 255;
            high[c] = sum[c] = 0;
            weight[c] = static_cast<int32_t>(weights.weight[c]);
            for (const float texel : texels.channel[c]) {
                const auto value = static_cast<int32_t>(texel);
                low[c] = std::min(low[c], value);
                high[c] = std::max(high[c], value);
                sum[c] += value;
            }
        }
    }

    /// The texels' mean is no nearer to the colours between the endpoints than the texels are on average (squares are
    /// convex); nor are the texels of the extremes.
    inline CITYSTREAM_INLINED int32_t least_error(int32_t endpoints) const {
        int32_t bound = 0;
        for (int c = 0; c < 3; ++c) {
            int32_t from, to;
            expand_channel(endpoints, c, from);
            expand_channel(endpoints >> 16, c, to);
            const int32_t first = std::min(from, to), last = std::max(from, to);
            constexpr int32_t kCount = kTexels;
            const int32_t off = std::max(std::max(sum[c] - kCount * last, kCount * first - sum[c]), 0);
            const int32_t above = std::max(high[c] - last, 0), below = std::max(first - low[c], 0);
            bound += std::max(off * off >> 4, above * above + below * below) * weight[c];
        }
        return bound;
    }
};

/// The four colours of eight endpoints.
struct LanePalettes {
    Lanes colour[4][3];

    inline CITYSTREAM_INLINED explicit LanePalettes(const uint32_t endpoints[kLanes]) {
        LaneInts words;
        std::memcpy(&words, endpoints, sizeof words);
        const LaneInts upper = words >> 16;
        for (int c = 0; c < 3; ++c) {
            LaneInts from, to;
            expand_channel(words, c, from);
            expand_channel(upper, c, to);
            constexpr int32_t kThird = 43691;  // of 2^17: exact below 2^16
            const LaneInts near = (2 * from + to + 1) * kThird >> 17, far = (from + 2 * to + 1) * kThird >> 17;
            colour[0][c] = __builtin_convertvector(from, Lanes);
            colour[1][c] = __builtin_convertvector(to, Lanes);
            colour[2][c] = __builtin_convertvector(near, Lanes);
            colour[3][c] = __builtin_convertvector(far, Lanes);
        }
    }
};

/// Weights of 1: the squared distance of a texel t and a colour c is |t|^2 + |c|^2 - 2 t c; all numbers stay below
/// 2^24.
inline CITYSTREAM_INLINED void sum_unweighted(const Bc1Texels& texels, const LanePalettes& palettes, LaneInts& errors) {
    Lanes square[4], twice[4][3];
    for (int code = 0; code < 4; ++code) {
        const auto& [r, g, b] = palettes.colour[code];
        square[code] = r * r + g * g + b * b;
        for (int c = 0; c < 3; ++c) twice[code][c] = 2 * palettes.colour[code][c];
    }
    Lanes sum = {};
    float texel_squares = 0;
    for (size_t i = 0; i < kTexels; ++i) {
        const float r = texels.channel[0][i], g = texels.channel[1][i], b = texels.channel[2][i];
        texel_squares += r * r + g * g + b * b;
        Lanes least = {};
        for (int code = 0; code < 4; ++code) {
            const Lanes error = square[code] - r * twice[code][0] - g * twice[code][1] - b * twice[code][2];
            least = code == 0 ? error : error < least ? error : least;
        }
        sum += least;
    }
    sum += texel_squares;
    errors = __builtin_convertvector(sum, LaneInts);
}

inline CITYSTREAM_INLINED void sum_weighted(const Bc1Texels& texels, const LanePalettes& palettes,
                                            const ChannelWeights& weights, LaneInts& errors) {
    errors = LaneInts{};
    for (size_t i = 0; i < kTexels; ++i) {
        Lanes least = {};
        for (int code = 0; code < 4; ++code) {
            Lanes error = {};
            for (int c = 0; c < 3; ++c) {
                const Lanes difference = texels.channel[c][i] - palettes.colour[code][c];
                error += difference * difference * static_cast<float>(weights.weight[c]);
            }
            least = code == 0 ? error : error < least ? error : least;
        }
        errors += __builtin_convertvector(least, LaneInts);
    }
}

}  // namespace

void bound_bc1_errors(const Bc1Texels& texels, const ChannelWeights& weights, std::span<const uint32_t> endpoints,
                      std::span<int32_t> bounds) {
    assert(endpoints.size() == bounds.size());
    const BlockRange range(texels, weights);
    const uint32_t* words = endpoints.data();
    int32_t* out = bounds.data();
    const size_t count = endpoints.size();
    run_wide([=, &range]() CITYSTREAM_INLINED {
        CITYSTREAM_INDEPENDENT
        for (size_t i = 0; i < count; ++i) out[i] = range.least_error(static_cast<int32_t>(words[i]));
    });
}

void least_bc1_errors(const Bc1Texels& texels, const ChannelWeights& weights, std::span<const uint32_t> endpoints,
                      std::span<uint32_t> errors) {
    assert(endpoints.size() == errors.size());
    const bool unweighted = weights == ChannelWeights{};
    run_wide([&]() CITYSTREAM_INLINED {
        for (size_t begin = 0; begin < endpoints.size(); begin += kLanes) {
            const size_t count = std::min(kLanes, endpoints.size() - begin);
            uint32_t words[kLanes] = {};
            std::memcpy(words, &endpoints[begin], count * sizeof(uint32_t));
            const LanePalettes palettes(words);
            LaneInts sums;
            if (unweighted) {
                sum_unweighted(texels, palettes, sums);
            } else {
                sum_weighted(texels, palettes, weights, sums);
            }
            std::memcpy(&errors[begin], &sums, count * sizeof(uint32_t));
        }
    });
}

Bc1RowErrors::Bc1RowErrors(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints) {
    float code_error[4][kTexels];
    bc1_code_errors(texels, weights, endpoints, code_error);
    run_wide([this, &code_error]() CITYSTREAM_INLINED {
        for (size_t row = 0; row < 4; ++row) {
            int32_t pair[2][16];
            for (size_t half = 0; half < 2; ++half) {
                const size_t texel = 4 * row + 2 * half;
                for (size_t codes = 0; codes < 16; ++codes) {
                    pair[half][codes] = static_cast<int32_t>(code_error[codes & 3][texel]) +
                                        static_cast<int32_t>(code_error[codes >> 2][texel + 1]);
                }
            }
            for (size_t high = 0; high < 16; ++high) {
                for (size_t low = 0; low < 16; ++low) error_[row][high * 16 + low] = pair[0][low] + pair[1][high];
            }
        }
    });
}

uint64_t Bc1RowErrors::weigh(std::span<const uint32_t> indices, std::span<const uint32_t> costs,
                             std::span<uint64_t> js) const {
    assert(indices.size() == costs.size() && indices.size() == js.size());
    for (size_t i = 0; i < indices.size(); ++i) js[i] = of(indices[i]);
    const size_t count = js.size();
    const uint32_t* added = costs.data();
    uint64_t* out = js.data();
    int64_t least = INT64_MAX;  // signed numbers are compared in one instruction
    run_wide([=, &least]() CITYSTREAM_INLINED {
        int64_t smallest = INT64_MAX;
        for (size_t i = 0; i < count; ++i) {
            const uint64_t j = out[i] * kErrorUnits + added[i];
            smallest = std::min(smallest, static_cast<int64_t>(j));
            out[i] = j;
        }
        least = smallest;
    });
    return static_cast<uint64_t>(least);
}

uint32_t Bc1RowErrors::cheapest(std::span<const int32_t, 256> byte_costs) const {
    uint32_t word = 0;
    const int32_t* costs = byte_costs.data();
    run_wide([this, &word, costs]() CITYSTREAM_INLINED {
        for (uint32_t row = 0; row < 4; ++row) {
            int32_t js[256];
            int32_t least = std::numeric_limits<int32_t>::max();
            for (size_t byte = 0; byte < 256; ++byte) {
                js[byte] = error_[row][byte] * static_cast<int32_t>(kErrorUnits) + costs[byte];
                least = std::min(least, js[byte]);
            }
            int32_t first = 255;
            for (int32_t byte = 0; byte < 256; ++byte) {
                const int32_t outside = js[byte] == least ? 0 : 255;
                first = std::min(first, std::max(byte, outside));
            }
            word |= static_cast<uint32_t>(first) << (8 * row);
        }
    });
    return word;
}

}  // namespace citystream::codec::atlas
