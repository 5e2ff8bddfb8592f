// Lookups in the binary factor form of a facade map (binary_layout.h). Paper: listing 1, with the faults corrected (any number of terms,
// bit 31, the index of the bit) and an early end: at most one term counts.
#ifndef CITYSTREAM_FACADE_LOOKUP_BINARY_GLSL
#define CITYSTREAM_FACADE_LOOKUP_BINARY_GLSL

#include "codec/facade/binary_layout.h"
#include "shaders/facade_ray.glsl"

// A descriptor: X, Y, sigma, words of a row; least, X index, Y index, terms.
struct BinaryFactors {
    uvec4 parts;
    uvec4 more;
};

BinaryFactors binary_factors(FacadeMap map, uint word) {
    return BinaryFactors(layer_words4(map.layer, word >> 2), layer_words4(map.layer, (word >> 2) + 1u));
}

BinaryFactors binary_displacement_factors(FacadeMap map) {
    return BinaryFactors(map.own, layer_words4(map.layer, (FACADE_BINARY_WORD_DISPLACEMENT >> 2) + 1u));
}

uint binary_row(FacadeMap map, uint index_base, uint i) {
    return layer_word(map.layer, index_base + (i >> 1)) >> (16u * (i & 1u)) & 0xffffu;
}

uint binary_entry(FacadeMap map, BinaryFactors factors, uint x, uint y) {
    if ((map.head.w & FACADE_BINARY_FLAG_SHARED) != 0u && factors.parts.w != 0u) {
        y = binary_row(map, factors.more.y, y);
        x = binary_row(map, factors.more.z, x);
    }
    uint row = factors.parts.x + y * factors.parts.w;
    uint column = factors.parts.y + x * factors.parts.w;
    for (uint w = 0u; w < factors.parts.w; ++w) {
        uint both = layer_word(map.layer, row + w) & layer_word(map.layer, column + w);
        if (both != 0u) return factors.more.x + layer_word(map.layer, factors.parts.z + 32u * w + uint(findLSB(both)));
    }
    return factors.more.x;
}

uint binary_material(FacadeMap map, uint x, uint y) {
    return binary_entry(map, binary_factors(map, uint(FACADE_BINARY_WORD_MATERIAL)), x, y);
}

uint lookup_binary(FacadeMap map, uint x, uint y) {
    return (binary_entry(map, binary_displacement_factors(map), x, y) & 0xffffu) | binary_material(map, x, y) << 16;
}

#endif
