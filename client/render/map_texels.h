// Environment maps as shaders read them: one word a texel, three 9-bit fractions and one exponent (the format of
// VK_FORMAT_E5B9G9R9_UFLOAT_PACK32), times a power of two that is the map's.
#pragma once

#include <cstdint>
#include <vector>

#include "client/light/environment_map.h"

namespace citystream::client {

/// Nearest, of finite channels at least 0 of which the greatest is below 2^16. Channels are off by at most 2^-9 of the
/// greatest of the three, or 2^-25.
uint32_t pack_shared_exponent(const Rgb& colour);
Rgb unpack_shared_exponent(uint32_t word);

struct MapTexels {
    std::vector<uint32_t> words;  ///< a texel each, as in the map
    float scale = 1;              ///< what unpacked texels are multiplied by: a power of two
};

/// The scale is the least with which all texels fit, so that dark maps keep their steps, too. O(texels).
MapTexels map_texels(const EnvironmentMap& map);

}  // namespace citystream::client
