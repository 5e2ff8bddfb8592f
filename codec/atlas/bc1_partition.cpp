#include "codec/atlas/bc1_partition.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <vector>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr int kLanes = kPartitionLanes;
constexpr int kMoves = 4;
/// Rounding the endpoints costs most blocks more than this per channel's weight: what gains less than it over the best
/// before rounding is not looked at. Saves a fifth of the time and costs 0.002 dB.
constexpr float kMargin = 12;

// One number of each block. Only passed by reference: how vectors of 32 bytes are passed by value depends on the
// processor.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using LaneInts = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));
// The channels of one block.
using Quad = float __attribute__((vector_size(16)));

/// Colours relative to the block's mean, in sixteenths times the root of the channel's weight.
struct CentredColours {
    Lanes channel[3][kTexels];
    Lanes mean[3];  ///< plain
    float unit[3];  ///< one sixteenth over the root: times this, differences are plain too
    float weight[3];
};

inline CITYSTREAM_INLINED void centre(std::span<const Bc1Texels, kPartitionLanes> blocks, const ChannelWeights& weights,
                                      CentredColours& centred) {
    for (int c = 0; c < 3; ++c) {
        centred.weight[c] = static_cast<float>(weights.weight[c]);
        const float root = std::sqrt(centred.weight[c]);
        centred.unit[c] = 1.0f / (16.0f * root);
        Lanes sum = {};
        for (int i = 0; i < kTexels; ++i) {
            float values[kLanes];
            for (size_t lane = 0; lane < kLanes; ++lane) values[lane] = blocks[lane].channel[c][i];
            std::memcpy(&centred.channel[c][i], values, sizeof values);
            sum += centred.channel[c][i];
        }
        centred.mean[c] = sum * (1.0f / 16.0f);
        for (int i = 0; i < kTexels; ++i) centred.channel[c][i] = (centred.channel[c][i] * 16.0f - sum) * root;
    }
}

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric {
    Lanes entry[6];

    /// The trace becomes about 1.
    inline CITYSTREAM_INLINED void scale() {
        constexpr float kTiny = 1e-12f;
        const Lanes trace = entry[0] + entry[3] + entry[5], least = Lanes{} + kTiny;
        const Lanes factor = 1.0f / (trace > least ? trace : least);
        for (Lanes& value : entry) value *= factor;
    }
    inline CITYSTREAM_INLINED void square() {
        const auto [xx, xy, xz, yy, yz, zz] = entry;
        entry[0] = xx * xx + xy * xy + xz * xz;
        entry[1] = xx * xy + xy * yy + xz * yz;
        entry[2] = xx * xz + xy * yz + xz * zz;
        entry[3] = xy * xy + yy * yy + yz * yz;
        entry[4] = xy * xz + yy * yz + yz * zz;
        entry[5] = xz * xz + yz * yz + zz * zz;
    }
};

/// Direction of the largest spread, about unit length; zero where the colours are equal. Squaring the covariance four
/// times leaves little but its first eigenvector, in every column.
inline CITYSTREAM_INLINED void principal_axis(const CentredColours& colours, Lanes axis[3]) {
    Symmetric matrix = {};
    const auto& [r, g, b] = colours.channel;
    for (int i = 0; i < kTexels; ++i) {
        const Lanes products[6] = {r[i] * r[i], r[i] * g[i], r[i] * b[i], g[i] * g[i], g[i] * b[i], b[i] * b[i]};
        for (int k = 0; k < 6; ++k) matrix.entry[k] += products[k];
    }
    for (int round = 0; round < 4; ++round) {
        matrix.scale();
        matrix.square();
    }
    matrix.scale();
    // The column of the largest diagonal entry is the longest.
    const auto& [xx, xy, xz, yy, yz, zz] = matrix.entry;
    const LaneInts first = (xx >= yy) & (xx >= zz);
    const LaneInts second = yy >= zz;
    const Lanes columns[2][3] = {{xy, yy, yz}, {xz, yz, zz}}, first_column[3] = {xx, xy, xz};
    for (int c = 0; c < 3; ++c) {
        const Lanes other = second ? columns[0][c] : columns[1][c];
        axis[c] = first ? first_column[c] : other;
    }
}

/// Batcher's odd-even merge sort: 63 exchanges for 16 keys.
inline CITYSTREAM_INLINED void sort_keys(Lanes keys[kTexels]) {
    for (int p = 1; p < kTexels; p *= 2) {
        for (int k = p; k >= 1; k /= 2) {
            for (int j = k % p; j + k < kTexels; j += 2 * k) {
                for (int i = 0; i < k; ++i) {
                    if ((i + j) / (2 * p) != (i + j + k) / (2 * p)) continue;
                    const Lanes a = keys[i + j], b = keys[i + j + k];
                    keys[i + j] = a < b ? a : b;
                    keys[i + j + k] = a > b ? a : b;
                }
            }
        }
    }
}

/// order[rank][lane]: texels by their place along the axis, the furthest first.
inline CITYSTREAM_INLINED void order_texels(const CentredColours& colours, const Lanes axis[3],
                                            uint8_t order[kTexels][kLanes]) {
    Lanes along[kTexels];
    Lanes furthest = Lanes{} + 1e-6f;
    for (int i = 0; i < kTexels; ++i) {
        along[i] = Lanes{};
        for (int c = 0; c < 3; ++c) along[i] += axis[c] * colours.channel[c][i];
        const Lanes far = along[i] > -along[i] ? along[i] : -along[i];
        furthest = furthest > far ? furthest : far;
    }
    // A key holds the place in its upper bits, and the texel's number, so that no two are equal: whole, below 2^24.
    const Lanes scale = 500000.0f / furthest;
    for (int i = 0; i < kTexels; ++i) {
        const LaneInts place = __builtin_convertvector(along[i] * scale, LaneInts);
        along[i] = __builtin_convertvector(place * -16 + i, Lanes);
    }
    sort_keys(along);
    for (int rank = 0; rank < kTexels; ++rank) {
        const LaneInts key = __builtin_convertvector(along[rank], LaneInts) & 15;
        for (int lane = 0; lane < kLanes; ++lane) order[rank][lane] = static_cast<uint8_t>(key[lane]);
    }
}

/// Ranks 0 .. first - 1 take c0, up to second - 1 the colour next to it, and so on.
struct Partition {
    int first, second, third;
    float gain;      ///< of |v|^2 in sixteenths: the most that the error falls by
    float to0, to1;  ///< the best c0 is mean + to0 v, the best c1 mean - to1 v
    float aa, ab, bb;
};

Partition make_partition(int first, int second, int third) {
    const int count[4] = {kTexels - third, third - second, second - first, first};  // by weight of c0
    int aa = 0, ab = 0, bb = 0;
    for (int w = 0; w < 4; ++w) {
        aa += count[w] * w * w;
        ab += count[w] * w * (3 - w);
        bb += count[w] * (3 - w) * (3 - w);
    }
    const int determinant = aa * bb - ab * ab;
    const float scale = determinant == 0 ? 0.0f : 1.0f / static_cast<float>(determinant);
    return {first,
            second,
            third,
            144.0f / 256.0f * scale,
            static_cast<float>(3 * (bb + ab)) * scale,
            static_cast<float>(3 * (aa + ab)) * scale,
            static_cast<float>(aa) * (1.0f / 9.0f),
            static_cast<float>(2 * ab) * (1.0f / 9.0f),
            static_cast<float>(bb) * (1.0f / 9.0f)};
}

/// What the partition gains when the sorted colours are equally spaced.
float gain_of_ramp(const Partition& partition) {
    const auto below = [](int rank) { return static_cast<float>(rank * (kTexels - rank)); };
    const float v = below(partition.first) + below(partition.second) + below(partition.third);
    return v * v * partition.gain;
}

struct Partitions {
    std::vector<Partition> all;      ///< but the whole block in one colour; what fits a ramp first
    std::vector<Partition> even;     ///< those of even ranks, alike
    std::vector<Partition> by_rank;  ///< [first][second][third], 17 each

    const Partition& at(int first, int second, int third) const {
        return by_rank[static_cast<size_t>((first * (kTexels + 1) + second) * (kTexels + 1) + third)];
    }
};

Partitions make_partitions() {
    Partitions partitions;
    for (int first = 0; first <= kTexels; ++first) {
        for (int second = 0; second <= kTexels; ++second) {
            for (int third = 0; third <= kTexels; ++third) {
                const bool ordered = first <= second && second <= third;
                const Partition& partition =
                    partitions.by_rank.emplace_back(ordered ? make_partition(first, second, third) : Partition{});
                const bool even = first % 2 == 0 && second % 2 == 0 && third % 2 == 0;
                if (partition.gain <= 0) continue;
                partitions.all.push_back(partition);
                if (even) partitions.even.push_back(partition);
            }
        }
    }
    // Mostly it is one of the first that is best, and most others then need no close look.
    const auto before = [](const Partition& a, const Partition& b) { return gain_of_ramp(a) > gain_of_ramp(b); };
    std::stable_sort(partitions.all.begin(), partitions.all.end(), before);
    std::stable_sort(partitions.even.begin(), partitions.even.end(), before);
    return partitions;
}

template <typename Vector>
struct IntsOf;
template <>
struct IntsOf<Lanes> {
    using Type = LaneInts;
};
template <>
struct IntsOf<Quad> {
    using Type = int32_t __attribute__((vector_size(16)));
};

/// `last` is a float or a vector.
template <typename Vector, typename Number>
inline CITYSTREAM_INLINED void clamp_and_round(Vector& value, const Number& last) {
    const Vector limit = Vector{} + last, none = {};
    value = value < limit ? value : limit;
    value = value > none ? value : none;
    value = __builtin_convertvector(__builtin_convertvector(value + 0.5f, typename IntsOf<Vector>::Type), Vector);
}

/// A channel's part of what the error really falls by, with endpoints inside the range of colours and on their grid.
/// `Vector` is a channel of several blocks, or all channels of one.
template <typename Vector, typename Number>
inline CITYSTREAM_INLINED void rounded_gain(const Partition& partition, const Vector& v, const Vector& mean,
                                            const Number& last, const Number& to_grid, const Number& from_grid,
                                            Vector& gain) {
    Vector a = (mean + v * partition.to0) * to_grid, b = (mean - v * partition.to1) * to_grid;
    clamp_and_round(a, last);
    clamp_and_round(b, last);
    a = a * from_grid - mean;
    b = b * from_grid - mean;
    gain = (a - b) * v * (2.0f / 3.0f) - a * a * partition.aa - a * b * partition.ab - b * b * partition.bb;
}

inline CITYSTREAM_INLINED bool any(const LaneInts& mask) {
    using Parts = int64_t __attribute__((vector_size(sizeof(LaneInts))));
    const auto parts = reinterpret_cast<Parts>(mask);
    int64_t all = 0;
    for (size_t i = 0; i < sizeof(LaneInts) / sizeof(int64_t); ++i) all |= parts[i];
    return all != 0;
}

/// Sums of the first colours along the axis.
struct Prefixes {
    Lanes sum[kTexels + 1][3];
};

inline CITYSTREAM_INLINED void add_prefixes(const CentredColours& colours, const uint8_t order[kTexels][kLanes],
                                            Prefixes& prefixes) {
    for (int c = 0; c < 3; ++c) {
        prefixes.sum[0][c] = Lanes{};
        float values[kTexels][kLanes];
        std::memcpy(values, colours.channel[c], sizeof values);
        for (int rank = 0; rank < kTexels; ++rank) {
            float ordered[kLanes];
            for (int lane = 0; lane < kLanes; ++lane) ordered[lane] = values[order[rank][lane]][lane];
            Lanes colour;
            std::memcpy(&colour, ordered, sizeof colour);
            prefixes.sum[rank + 1][c] = prefixes.sum[rank][c] + colour;
        }
    }
}

constexpr float kLast[3] = {31.0f, 63.0f, 31.0f};

/// The best partition's number in each lane. Lanes do not touch each other.
inline CITYSTREAM_INLINED void find_best(const std::vector<Partition>& partitions, const CentredColours& colours,
                                         const Prefixes& prefixes, LaneInts& found) {
    const float margin = kMargin * (colours.weight[0] + colours.weight[1] + colours.weight[2]);
    Lanes best = Lanes{} - 1e30f;
    LaneInts number = {};
    found = LaneInts{};
    for (const Partition& partition : partitions) {
        const Lanes* first = prefixes.sum[partition.first];
        const Lanes* second = prefixes.sum[partition.second];
        const Lanes* third = prefixes.sum[partition.third];
        Lanes v[3];
        for (int c = 0; c < 3; ++c) v[c] = first[c] + second[c] + third[c];
        // The least squares' own gain is a bound for what is left of it on the grid: not all partitions need the
        // latter.
        const LaneInts open = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * partition.gain > best + margin;
        if (any(open)) {
            Lanes gain = {};
            for (int c = 0; c < 3; ++c) {
                Lanes own;
                rounded_gain(partition, Lanes(v[c] * colours.unit[c]), colours.mean[c], kLast[c], kLast[c] / 255.0f,
                             255.0f / kLast[c], own);
                gain += own * colours.weight[c];
            }
            const LaneInts better = (gain > best) & open;
            best = better ? gain : best;
            found = better ? number : found;
        }
        number += 1;
    }
}

/// Moves to the best neighbour until there is none better, in one lane.
const Partition& descend(const CentredColours& colours, const Prefixes& prefixes, int lane,
                         const Partitions& partitions, const Partition& from) {
    Quad sum[kTexels + 1];
    for (int rank = 0; rank <= kTexels; ++rank) {
        const auto& channels = prefixes.sum[rank];
        sum[rank] = Quad{channels[0][lane], channels[1][lane], channels[2][lane], 0};
    }
    const Quad unit = {colours.unit[0], colours.unit[1], colours.unit[2], 0};
    const Quad mean = {colours.mean[0][lane], colours.mean[1][lane], colours.mean[2][lane], 0};
    const Quad weight = {colours.weight[0], colours.weight[1], colours.weight[2], 0};
    const Quad last = {kLast[0], kLast[1], kLast[2], 1};
    const Quad to_grid = last / 255.0f, from_grid = 255.0f / last;
    const Partition* best = &from;
    float best_gain = -1e30f;
    const auto weigh_neighbours = [&](const Partition& start) {
        for (int first = std::max(start.first - 1, 0); first <= std::min(start.first + 1, kTexels); ++first) {
            for (int second = std::max(start.second - 1, first); second <= std::min(start.second + 1, kTexels);
                 ++second) {
                const Quad low = sum[first] + sum[second];
                for (int third = std::max(start.third - 1, second); third <= std::min(start.third + 1, kTexels);
                     ++third) {
                    const Partition& partition = partitions.at(first, second, third);
                    const Quad v = low + sum[third];
                    const Quad squares = v * v;
                    if ((squares[0] + squares[1] + squares[2]) * partition.gain <= best_gain) continue;
                    Quad gains;
                    rounded_gain(partition, Quad(v * unit), mean, last, to_grid, from_grid, gains);
                    gains *= weight;
                    const float gain = gains[0] + gains[1] + gains[2];
                    if (gain <= best_gain) continue;
                    best_gain = gain;
                    best = &partition;
                }
            }
        }
    };
    for (int move = 0; move < kMoves; ++move) {
        const Partition* start = best;
        weigh_neighbours(*start);
        if (best == start) break;
    }
    return *best;
}

uint32_t index_word(const Partition& partition, const uint8_t order[kTexels][kLanes], int lane) {
    uint32_t word = 0;
    for (int rank = 0; rank < kTexels; ++rank) {
        const uint32_t code = rank < partition.first    ? 0u
                              : rank < partition.second ? 2u
                              : rank < partition.third  ? 3u
                                                        : 1u;
        word |= code << (2 * order[rank][lane]);
    }
    return word;
}

}  // namespace

void partition_texels(std::span<const Bc1Texels, kPartitionLanes> blocks, const ChannelWeights& weights,
                      PartitionSearch search, std::span<uint32_t, kPartitionLanes> indices) {
    assert(std::all_of(std::begin(weights.weight), std::end(weights.weight),
                       [](uint32_t w) { return w >= 1 && w <= 85; }));
    static const Partitions partitions = make_partitions();
    const bool whole = search == PartitionSearch::kAll;
    const std::vector<Partition>& candidates = whole ? partitions.all : partitions.even;
    CentredColours colours;
    Prefixes prefixes;
    uint8_t order[kTexels][kLanes];
    LaneInts found;
    run_wide([&]() CITYSTREAM_INLINED {
        centre(blocks, weights, colours);
        Lanes axis[3];
        principal_axis(colours, axis);
        order_texels(colours, axis, order);
        add_prefixes(colours, order, prefixes);
        find_best(candidates, colours, prefixes, found);
    });
    for (int lane = 0; lane < kLanes; ++lane) {
        const Partition& best = candidates[static_cast<size_t>(found[lane])];
        indices[static_cast<size_t>(lane)] =
            index_word(whole ? best : descend(colours, prefixes, lane, partitions, best), order, lane);
    }
}

}  // namespace citystream::codec::atlas
