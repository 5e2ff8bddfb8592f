// Where the 16 texels of a block fall into the four colours of BC1: the partition along the block's principal axis
// whose unquantised least-squares endpoints are best, among all of them (cluster fit), for eight blocks at a time.
//
// With centred colours the least-squares optimum of a partition is a closed form: let w be the weight (thirds) of c0 in
// a texel's colour and v = sum of w * (colour - mean). Then the squared error falls by 144 |v|^2 / (aa bb - ab ab),
// where aa, ab, bb are the sums of w^2, w (3 - w), (3 - w)^2; and v is the sum of three prefix sums of the sorted
// colours.
#pragma once

#include <cstdint>
#include <span>

namespace citystream::codec::atlas {

/// 16 texels in row-major order, channels apart: whole numbers 0..255, in float so that the compiler can work on
/// several at once.
struct Bc1Texels {
    float channel[3][16];
};

/// Weights of the squared error in r, g, b, each 1..85 (sums of a texel's weighted squares stay exact in a float).
struct ChannelWeights {
    uint32_t weight[3] = {1, 1, 1};
    friend bool operator==(const ChannelWeights&, const ChannelWeights&) = default;
};

inline constexpr uint32_t kPartitionLanes = 8;

enum class PartitionSearch {
    kAll,   ///< all 965 partitions: cluster fit
    kEven,  ///< the 161 whose colours change at even ranks, then downhill from the best: about twice as fast, 0.1 dB
            ///< less
};

/// BC1 index words (0, 2, 3, 1 along the axis) of the best partition of each block; any where all texels are equal. The
/// same for every compiler and machine with IEEE arithmetic (floats are added, multiplied and compared, never fused).
void partition_texels(std::span<const Bc1Texels, kPartitionLanes> blocks, const ChannelWeights& weights,
                      PartitionSearch search, std::span<uint32_t, kPartitionLanes> indices);

}  // namespace citystream::codec::atlas
