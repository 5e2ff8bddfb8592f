// Lookups in the quotient form of a facade map (codec/facade/quotient_layout.h): class of the column, class of the row, cell; and the label,
// where cells are indexes. Twin of quotient_label.
#ifndef CITYSTREAM_FACADE_LOOKUP_QUOTIENT_GLSL
#define CITYSTREAM_FACADE_LOOKUP_QUOTIENT_GLSL

#include "shaders/facade_runs.glsl"

// As many classes as texels: the texel is the class.
uint quotient_column(FacadeMap map, uint x) {
    if (low_bits(map.head.w, uint(QUOTIENT_CLASS_BITS)) == map_width(map)) return x;
    return section_field(map.layer, map.own.y & 0xffffu, x, map.own.x & 15u);
}

uint quotient_row(FacadeMap map, uint y) {
    if (low_bits(map.head.w >> uint(QUOTIENT_CLASS_BITS), uint(QUOTIENT_CLASS_BITS)) == map_height(map)) return y;
    return section_field(map.layer, map.own.y >> 16, y, map.own.x >> 4 & 15u);
}

uint quotient_class_label(FacadeMap map, uint column, uint row) {
    uint index = row * low_bits(map.head.w, uint(QUOTIENT_CLASS_BITS)) + column;
    uint bits = map.own.x >> 8 & 63u;
    bool dense = (map.head.w >> uint(QUOTIENT_DENSE_BIT) & 1u) != 0u;
    uint cell = dense ? dense_field(map.layer, map.own.w, index * bits, bits) : section_field(map.layer, map.own.w, index, bits);
    if ((map.head.w >> uint(QUOTIENT_DIRECT_BIT) & 1u) != 0u) return numbered_label(map, cell, map.own.x >> 14, map.own.z);
    return layer_word(map.layer, 4u * map.own.z + cell);
}

uint lookup_quotient(FacadeMap map, uint x, uint y) {
    return quotient_class_label(map, quotient_column(map, x), quotient_row(map, y));
}

#endif
