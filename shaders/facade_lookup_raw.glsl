// Lookups in the raw form of a facade map (raw_layout.h): plain D, M and box index A.
#ifndef CITYSTREAM_FACADE_LOOKUP_RAW_GLSL
#define CITYSTREAM_FACADE_LOOKUP_RAW_GLSL

#include "codec/facade/raw_layout.h"
#include "shaders/facade_ray.glsl"

uint raw_entry(FacadeMap map, uint base, uint bits, uint x, uint y) {
    uint bit = (y * map_width(map) + x) * bits;
    uint value = layer_word(map.layer, base + (bit >> 5)) >> (bit & 31u);
    return bits == 32u ? value : value & ((1u << bits) - 1u);
}

// As the low half of a label.
uint raw_displacement(FacadeMap map, uint x, uint y) { return raw_entry(map, map.own.x, 16u, x, y); }
uint raw_material(FacadeMap map, uint x, uint y) { return raw_entry(map, map.own.y, map.head.w & 255u, x, y); }
bool raw_has_boxes(FacadeMap map) { return (map.head.w >> 8 & 255u) != 0u; }
uint raw_box_index(FacadeMap map, uint x, uint y) { return raw_entry(map, map.own.z, map.head.w >> 8 & 255u, x, y); }

uint lookup_raw(FacadeMap map, uint x, uint y) { return raw_displacement(map, x, y) | raw_material(map, x, y) << 16; }

#endif
