// Light of a tile's walls direction by direction: of each receiver on a wall what each local direction adds to its
// irradiance. The relief of a facade hides some directions from itself (relief_mask.h, btf.h), which irradiance alone
// cannot tell. Words are in local_light_layout.h; the fourth light pass (client/render/radiance_passes.h) gives the
// same, bit for bit: all of it is integers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/local_light_layout.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/source_light.h"

namespace citystream::codec::radiance {

/// Three channels below 2^31 as a word: rounded to nearest, of equals the greater, by the greatest channel's exponent.
uint32_t local_light_word(const std::array<uint32_t, 3>& value);
/// What a word stands for, in the same unit.
std::array<uint32_t, 3> local_light_value(uint32_t word);

/// Receivers on walls: those of the classes +x -x +y -y, which come first. `table`: the words of a receiver table of
/// which at least RECEIVER_HEADER_WORDS are given and the row tables that it names; what is not there counts as no row.
uint32_t wall_receivers(std::span<const uint32_t> table);

/// LOCAL_LIGHT_DIRECTIONS words a wall receiver. Empty where the layer has other local directions, or the light is not
/// of its number of texels. O(matrix + receivers times directions).
std::vector<uint32_t> local_light_words(const RadianceLayerView& layer, const WholeLight& light);

}  // namespace citystream::codec::radiance
