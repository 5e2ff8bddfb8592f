#include "codec/atlas/bc1.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace citystream::codec::atlas {

namespace {

constexpr int kTexels = 16;

bool all_equal(const Bc1Texels& texels) {
    bool equal = true;
    for (const auto& channel : texels.channel) {
        for (int i = 1; i < kTexels; ++i) equal &= channel[i] == channel[0];
    }
    return equal;
}

/// The nearest one-colour endpoints, with indices as they fit.
Bc1Block constant_block(const Bc1Texels& texels, const ChannelWeights& weights) {
    int32_t mean[3];
    for (int c = 0; c < 3; ++c) {
        float sum = kTexels / 2;
        for (const float value : texels.channel[c]) sum += value;
        mean[c] = static_cast<int32_t>(sum) / kTexels;
    }
    return fit_bc1_indices(texels, weights, bc1_constant_endpoints(mean));
}

/// Tries neighbours of the endpoints, one channel of one endpoint at a time, and keeps what is better.
Bc1Block step_endpoints(const Bc1Texels& texels, const ChannelWeights& weights, Bc1Block best) {
    constexpr uint32_t kShift[6] = {0, 5, 11, 16, 21, 27};
    constexpr uint32_t kMask[6] = {31, 63, 31, 31, 63, 31};
    // After a step that helped all others are tried again.
    int since = 0;
    for (int k = 0; since < 12; k = (k + 1) % 12, ++since) {
        const uint32_t shift = kShift[k / 2], mask = kMask[k / 2];
        const uint32_t level = best.endpoints >> shift & mask;
        if (level == (k % 2 == 0 ? 0 : mask)) continue;
        const uint32_t endpoints = k % 2 == 0 ? best.endpoints - (1u << shift) : best.endpoints + (1u << shift);
        const Bc1Block stepped = fit_bc1_indices(texels, weights, endpoints);
        if (stepped.error >= best.error) continue;
        best = stepped;
        since = -1;
    }
    return best;
}

/// Codes 0 and 1 for the texels of a block that has two colours; false when it has more.
bool two_colours(const Bc1Texels& texels, uint32_t& indices) {
    const auto equal = [&texels](int i, int k) {
        return texels.channel[0][i] == texels.channel[0][k] && texels.channel[1][i] == texels.channel[1][k] &&
               texels.channel[2][i] == texels.channel[2][k];
    };
    int other = 0;
    indices = 0;
    for (int i = 1; i < kTexels; ++i) {
        if (equal(i, 0)) continue;
        if (other == 0) other = i;
        if (!equal(i, other)) return false;
        indices |= 1u << (2 * i);
    }
    return true;
}

/// Blocks of one colour, and of two that the grid of endpoints has: nothing is left to search.
bool encode_simple_block(const Bc1Texels& texels, const ChannelWeights& weights, Bc1Block& block) {
    uint32_t indices = 0;
    if (all_equal(texels)) {
        block = constant_block(texels, weights);
        return true;
    }
    if (!two_colours(texels, indices)) return false;
    block = fit_bc1_indices(texels, weights, fit_bc1_endpoints(texels, weights, indices).endpoints);
    return block.error == 0;
}

Bc1Block best_block(const Bc1Texels& texels, uint32_t partition, const Bc1Options& options) {
    const ChannelWeights& weights = options.weights;
    Bc1Block best = fit_bc1_indices(texels, weights, fit_bc1_endpoints(texels, weights, partition).endpoints);
    for (int round = 1; round < options.rounds && best.error > 0; ++round) {
        const Bc1Block refit = fit_bc1_endpoints(texels, weights, best.indices);
        if (refit.error >= best.error) break;
        best = fit_bc1_indices(texels, weights, refit.endpoints);
    }
    // Nearly equal texels: the thirds around the mean can be finer than any pair of endpoints on the grid.
    const uint32_t weight = weights.weight[0] + weights.weight[1] + weights.weight[2];
    if (best.error < kTexels * 16 * weight) {
        const Bc1Block flat = constant_block(texels, weights);
        if (flat.error < best.error) best = flat;
    }
    return options.steps ? step_endpoints(texels, weights, best) : best;
}

/// Up to a partition search's number of blocks that need one.
struct Batch {
    std::array<Bc1Texels, kPartitionLanes> lanes;
    std::array<size_t, kPartitionLanes> block;
    size_t count = 0;

    void encode(const Bc1Options& options, std::span<Bc1Block> out) {
        for (size_t lane = count; lane < kPartitionLanes && count > 0; ++lane) lanes[lane] = lanes[count - 1];
        std::array<uint32_t, kPartitionLanes> partitions;
        if (count > 0) partition_texels(lanes, options.weights, options.search, partitions);
        for (size_t lane = 0; lane < count; ++lane)
            out[block[lane]] = best_block(lanes[lane], partitions[lane], options);
        count = 0;
    }
};

}  // namespace

void encode_bc1_blocks(std::span<const Bc1Texels> blocks, const Bc1Options& options, std::span<Bc1Block> out) {
    assert(out.size() == blocks.size());
    Batch batch;
    for (size_t i = 0; i < blocks.size(); ++i) {
        if (encode_simple_block(blocks[i], options.weights, out[i])) continue;
        batch.lanes[batch.count] = blocks[i];
        batch.block[batch.count++] = i;
        if (batch.count == kPartitionLanes) batch.encode(options, out);
    }
    batch.encode(options, out);
}

void encode_bc1_block(const uint8_t rgb[48], uint32_t out[2]) {
    const Bc1Texels texels = bc1_texels(rgb);
    Bc1Block block;
    encode_bc1_blocks(std::span(&texels, 1), {}, std::span(&block, 1));
    out[0] = block.endpoints;
    out[1] = block.indices;
}

std::vector<Bc1Texels> bc1_blocks_of(std::span<const uint8_t> rgb, uint32_t width, uint32_t height) {
    assert(width > 0 && height > 0 && rgb.size() == 3 * size_t{width} * height);
    std::vector<Bc1Texels> blocks;
    blocks.reserve(size_t{(width + 3) / 4} * ((height + 3) / 4));
    for (uint32_t by = 0; by < height; by += 4) {
        for (uint32_t bx = 0; bx < width; bx += 4) {
            Bc1Texels& texels = blocks.emplace_back();
            for (uint32_t i = 0; i < kTexels; ++i) {
                const size_t x = std::min(bx + i % 4, width - 1), y = std::min(by + i / 4, height - 1);
                for (size_t c = 0; c < 3; ++c) texels.channel[c][i] = rgb[3 * (y * width + x) + c];
            }
        }
    }
    return blocks;
}

std::vector<uint32_t> encode_bc1_image(std::span<const uint8_t> rgb, uint32_t width, uint32_t height,
                                       const Bc1Options& options) {
    const std::vector<Bc1Texels> texels = bc1_blocks_of(rgb, width, height);
    std::vector<Bc1Block> blocks(texels.size());
    encode_bc1_blocks(texels, options, blocks);
    std::vector<uint32_t> words;
    words.reserve(2 * blocks.size());
    for (const Bc1Block& block : blocks) {
        words.push_back(block.endpoints);
        words.push_back(block.indices);
    }
    return words;
}

void decode_bc1_texel(const uint32_t block[2], uint32_t i, uint8_t rgb[3]) {
    int32_t palette[4][3];
    bc1_palette(block[0], palette);
    const int32_t* colour = palette[block[1] >> (2 * i) & 3u];
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<uint8_t>(colour[c]);
}

}  // namespace citystream::codec::atlas
