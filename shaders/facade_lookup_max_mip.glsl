// Lookups in the maximum mip form of a facade map (max_mip_layout.h).
#ifndef CITYSTREAM_FACADE_LOOKUP_MAX_MIP_GLSL
#define CITYSTREAM_FACADE_LOOKUP_MAX_MIP_GLSL

#include "codec/facade/max_mip_layout.h"
#include "shaders/facade_ray.glsl"

// Entry of a level whose first word is `base`, as the low half of a label.
uint max_mip_entry(FacadeMap map, uint base, uint level, uint x, uint y) {
    uint across = (map_width(map) + (1u << level) - 1u) >> level;
    uint i = y * across + x;
    return layer_word(map.layer, base + (i >> 1)) >> (16u * (i & 1u)) & 0xffffu;
}

// Words of a level with its padding.
uint max_mip_level_words(FacadeMap map, uint level) {
    uint across = (map_width(map) + (1u << level) - 1u) >> level;
    uint upwards = (map_height(map) + (1u << level) - 1u) >> level;
    return (across * upwards + 7u) / 8u * 4u;
}

// First word of a level, counted rather than loaded.
uint max_mip_level_base(FacadeMap map, uint level) {
    uint base = uint(FACADE_MAX_MIP_HEADER_WORDS);
    for (uint k = 0u; k < level; ++k) base += max_mip_level_words(map, k);
    return base;
}

uint max_mip_displacement(FacadeMap map, uint x, uint y) {
    return max_mip_entry(map, uint(FACADE_MAX_MIP_HEADER_WORDS), 0u, x, y);
}

uint max_mip_material(FacadeMap map, uint x, uint y) {
    uint bits = map.head.w & 255u;
    uint bit = (y * map_width(map) + x) * bits;
    return layer_word(map.layer, map.own.x + (bit >> 5)) >> (bit & 31u) & ((1u << bits) - 1u);
}

uint lookup_max_mip(FacadeMap map, uint x, uint y) { return max_mip_displacement(map, x, y) | max_mip_material(map, x, y) << 16; }

#endif
