#include "codec/atlas/bc1_partition.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;
constexpr int kLanes = kPartitionLanes;
constexpr int kMoves = 4;
/// Rounding the endpoints costs most blocks more than this per channel's weight: what gains less than it over the best
/// before rounding is not looked at. Saves a fifth of the time and costs 0.002 dB.
constexpr float kMargin = 12;

// One number of each block. Four floats are one register of every 64-bit processor.
using Lanes = float __attribute__((vector_size(16)));
using LaneInts = int32_t __attribute__((vector_size(16)));

Lanes all(float value) {
    return Lanes{value, value, value, value};
}

Lanes choose(LaneInts mask, Lanes yes, Lanes no) {
    return reinterpret_cast<Lanes>((mask & reinterpret_cast<LaneInts>(yes)) | (~mask & reinterpret_cast<LaneInts>(no)));
}

Lanes larger(Lanes a, Lanes b) {
    return choose(a > b, a, b);
}

/// `last` is a float or one per lane.
template <typename Number>
Lanes clamp_and_round(Lanes value, Number last) {
    const Lanes limit = all(0) + last;
    const Lanes below = choose(value < limit, value, limit);
    const Lanes clamped = larger(below, all(0));
    return __builtin_convertvector(__builtin_convertvector(clamped + 0.5f, LaneInts), Lanes);
}

/// Colours relative to the block's mean, in sixteenths times the root of the channel's weight.
struct CentredColours {
    Lanes channel[3][kTexels];
    Lanes mean[3];  ///< plain
    float unit[3];  ///< one sixteenth over the root: times this, differences are plain too
    float weight[3];
};

CentredColours centre(std::span<const Bc1Texels, kPartitionLanes> blocks, const ChannelWeights& weights) {
    CentredColours centred;
    for (int c = 0; c < 3; ++c) {
        centred.weight[c] = static_cast<float>(weights.weight[c]);
        const float root = std::sqrt(centred.weight[c]);
        centred.unit[c] = 1.0f / (16.0f * root);
        Lanes sum = {};
        for (int i = 0; i < kTexels; ++i) {
            for (int lane = 0; lane < kLanes; ++lane)
                centred.channel[c][i][lane] = blocks[static_cast<size_t>(lane)].channel[c][i];
            sum += centred.channel[c][i];
        }
        centred.mean[c] = sum * (1.0f / 16.0f);
        for (int i = 0; i < kTexels; ++i) centred.channel[c][i] = (centred.channel[c][i] * 16.0f - sum) * root;
    }
    return centred;
}

struct Axis {
    Lanes channel[3];
};

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric {
    Lanes entry[6];

    Lanes trace() const { return entry[0] + entry[3] + entry[5]; }
    void scale(Lanes factor) {
        for (Lanes& value : entry) value *= factor;
    }
    Symmetric squared() const {
        const auto& [xx, xy, xz, yy, yz, zz] = entry;
        return {{xx * xx + xy * xy + xz * xz, xx * xy + xy * yy + xz * yz, xx * xz + xy * yz + xz * zz,
                 xy * xy + yy * yy + yz * yz, xy * xz + yy * yz + yz * zz, xz * xz + yz * yz + zz * zz}};
    }
};

/// Direction of the largest spread, about unit length; zero where the colours are equal. Squaring the covariance four
/// times leaves little but its first eigenvector, in every column.
Axis principal_axis(const CentredColours& colours) {
    Symmetric matrix = {};
    const auto& [r, g, b] = colours.channel;
    for (int i = 0; i < kTexels; ++i) {
        const Lanes products[6] = {r[i] * r[i], r[i] * g[i], r[i] * b[i], g[i] * g[i], g[i] * b[i], b[i] * b[i]};
        for (int k = 0; k < 6; ++k) matrix.entry[k] += products[k];
    }
    constexpr float kTiny = 1e-12f;
    for (int round = 0; round < 4; ++round) {
        matrix.scale(1.0f / larger(matrix.trace(), all(kTiny)));
        matrix = matrix.squared();
    }
    matrix.scale(1.0f / larger(matrix.trace(), all(kTiny)));
    // The column of the largest diagonal entry is the longest.
    const auto& [xx, xy, xz, yy, yz, zz] = matrix.entry;
    const LaneInts first = (xx >= yy) & (xx >= zz);
    const LaneInts second = yy >= zz;
    return {choose(first, xx, choose(second, xy, xz)), choose(first, xy, choose(second, yy, yz)),
            choose(first, xz, choose(second, yz, zz))};
}

void order_pair(Lanes& a, Lanes& b) {
    const LaneInts swap = a > b;
    const Lanes low = choose(swap, b, a);
    b = choose(swap, a, b);
    a = low;
}

/// Batcher's odd-even merge sort: 63 exchanges for 16 keys.
void sort_keys(Lanes keys[kTexels]) {
    for (int p = 1; p < kTexels; p *= 2) {
        for (int k = p; k >= 1; k /= 2) {
            for (int j = k % p; j + k < kTexels; j += 2 * k) {
                for (int i = 0; i < k; ++i) {
                    if ((i + j) / (2 * p) == (i + j + k) / (2 * p)) order_pair(keys[i + j], keys[i + j + k]);
                }
            }
        }
    }
}

/// order[rank][lane]: texels by their place along the axis, the furthest first.
void order_texels(const CentredColours& colours, const Axis& axis, uint8_t order[kTexels][kLanes]) {
    Lanes along[kTexels];
    Lanes furthest = all(1e-6f);
    for (int i = 0; i < kTexels; ++i) {
        along[i] = all(0);
        for (int c = 0; c < 3; ++c) along[i] += axis.channel[c] * colours.channel[c][i];
        furthest = larger(furthest, larger(along[i], -along[i]));
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

/// A channel's part of what the error really falls by, with endpoints inside the range of colours and on their grid.
/// `Number` is a channel of four blocks, or all channels of one.
template <typename Number>
Lanes rounded_gain(const Partition& partition, Lanes v, Lanes mean, Number last, Number to_grid, Number from_grid) {
    const Lanes a = clamp_and_round((mean + v * partition.to0) * to_grid, last) * from_grid - mean;
    const Lanes b = clamp_and_round((mean - v * partition.to1) * to_grid, last) * from_grid - mean;
    return (a - b) * v * (2.0f / 3.0f) - a * a * partition.aa - a * b * partition.ab - b * b * partition.bb;
}

bool any(LaneInts mask) {
    using Halves = int64_t __attribute__((vector_size(16)));
    const Halves halves = reinterpret_cast<Halves>(mask);
    return (halves[0] | halves[1]) != 0;
}

/// Sums of the first colours along the axis.
struct Prefixes {
    Lanes sum[kTexels + 1][3];
};

Prefixes prefix_sums(const CentredColours& colours, const uint8_t order[kTexels][kLanes]) {
    Prefixes prefixes = {};
    for (int rank = 0; rank < kTexels; ++rank) {
        for (int c = 0; c < 3; ++c) {
            Lanes colour;
            for (int lane = 0; lane < kLanes; ++lane) colour[lane] = colours.channel[c][order[rank][lane]][lane];
            prefixes.sum[rank + 1][c] = prefixes.sum[rank][c] + colour;
        }
    }
    return prefixes;
}

constexpr float kLast[3] = {31.0f, 63.0f, 31.0f};

/// The best partition's number in each lane.
LaneInts best_of(const std::vector<Partition>& partitions, const CentredColours& colours, const Prefixes& prefixes) {
    const float margin = kMargin * (colours.weight[0] + colours.weight[1] + colours.weight[2]);
    Lanes best = all(-1e30f);
    LaneInts number = {};
    LaneInts found = {};
    for (const Partition& partition : partitions) {
        const Lanes* first = prefixes.sum[partition.first];
        const Lanes* second = prefixes.sum[partition.second];
        const Lanes* third = prefixes.sum[partition.third];
        Lanes v[3];
        for (int c = 0; c < 3; ++c) v[c] = first[c] + second[c] + third[c];
        // The least squares' own gain is a bound for what is left of it on the grid: not all partitions need the
        // latter.
        if (any((v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * partition.gain > best + margin)) {
            Lanes gain = all(0);
            for (int c = 0; c < 3; ++c) {
                gain += rounded_gain(partition, v[c] * colours.unit[c], colours.mean[c], kLast[c], kLast[c] / 255.0f,
                                     255.0f / kLast[c]) *
                        colours.weight[c];
            }
            const LaneInts better = gain > best;
            best = choose(better, gain, best);
            found = (better & number) | (~better & found);
        }
        number += 1;
    }
    return found;
}

/// Moves to the best neighbour until there is none better, in one lane.
const Partition& descend(const CentredColours& colours, const Prefixes& prefixes, int lane,
                         const Partitions& partitions, const Partition& from) {
    Lanes sum[kTexels + 1];
    for (int rank = 0; rank <= kTexels; ++rank) {
        const auto& channels = prefixes.sum[rank];
        sum[rank] = Lanes{channels[0][lane], channels[1][lane], channels[2][lane], 0};
    }
    const Lanes unit = {colours.unit[0], colours.unit[1], colours.unit[2], 0};
    const Lanes mean = {colours.mean[0][lane], colours.mean[1][lane], colours.mean[2][lane], 0};
    const Lanes weight = {colours.weight[0], colours.weight[1], colours.weight[2], 0};
    const Lanes last = {kLast[0], kLast[1], kLast[2], 1};
    const Lanes to_grid = last / 255.0f, from_grid = 255.0f / last;
    const Partition* best = &from;
    float best_gain = -1e30f;
    const auto weigh_neighbours = [&](const Partition& start) {
        for (int first = std::max(start.first - 1, 0); first <= std::min(start.first + 1, kTexels); ++first) {
            for (int second = std::max(start.second - 1, first); second <= std::min(start.second + 1, kTexels);
                 ++second) {
                const Lanes low = sum[first] + sum[second];
                for (int third = std::max(start.third - 1, second); third <= std::min(start.third + 1, kTexels);
                     ++third) {
                    const Partition& partition = partitions.at(first, second, third);
                    const Lanes v = low + sum[third];
                    const Lanes squares = v * v;
                    if ((squares[0] + squares[1] + squares[2]) * partition.gain <= best_gain) continue;
                    const Lanes gains = rounded_gain(partition, v * unit, mean, last, to_grid, from_grid) * weight;
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
    const CentredColours colours = centre(blocks, weights);
    uint8_t order[kTexels][kLanes];
    order_texels(colours, principal_axis(colours), order);
    const Prefixes prefixes = prefix_sums(colours, order);
    const bool whole = search == PartitionSearch::kAll;
    const std::vector<Partition>& candidates = whole ? partitions.all : partitions.even;
    const LaneInts found = best_of(candidates, colours, prefixes);
    for (int lane = 0; lane < kLanes; ++lane) {
        const Partition& best = candidates[static_cast<size_t>(found[lane])];
        indices[static_cast<size_t>(lane)] =
            index_word(whole ? best : descend(colours, prefixes, lane, partitions, best), order, lane);
    }
}

}  // namespace citystream::codec::atlas
