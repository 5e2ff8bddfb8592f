// A layer's bytes, coarse to fine: the one shape that every codec writes and every client reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace citystream {

/// One step of a layer as a codec makes it. The decoded form of a layer prefix is the concatenation of `words` of its
/// steps: little-endian 32-bit words, uploaded to the GPU as they are. Adding a step only appends; nothing before it
/// changes.
struct LayerStep {
    std::vector<uint32_t> words;
    /// Error of the prefix that ends with this step: metres (mesh, facade), metres per texel (atlas). Never grows along
    /// a layer.
    float error = 0;
};

using LayerSteps = std::vector<LayerStep>;

}  // namespace citystream
