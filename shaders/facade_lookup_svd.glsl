// Lookups in the singular value form of a facade map (svd_layout.h). Paper: equation 6.
#ifndef CITYSTREAM_FACADE_LOOKUP_SVD_GLSL
#define CITYSTREAM_FACADE_LOOKUP_SVD_GLSL

#include "codec/facade/svd_layout.h"
#include "shaders/facade_ray.glsl"

vec4 svd_floats(FacadeMap map, uint group) {
    uvec4 words = layer_words4(map.layer, group);
    return vec4(uintBitsToFloat(words.x), uintBitsToFloat(words.y), uintBitsToFloat(words.z), uintBitsToFloat(words.w));
}

// `factors`: rows, columns, groups of a row, least.
uint svd_entry(FacadeMap map, uvec4 factors, uint x, uint y) {
    uint row = (factors.x >> 2) + y * factors.z;
    uint column = (factors.y >> 2) + x * factors.z;
    float sum = 0.0;
    for (uint g = 0u; g < factors.z; ++g) {
        vec4 a = svd_floats(map, row + g);
        vec4 b = svd_floats(map, column + g);
        sum = sum + a.x * b.x;
        sum = sum + a.y * b.y;
        sum = sum + a.z * b.z;
        sum = sum + a.w * b.w;
    }
    return factors.w + uint(floor(clamp(sum, 0.0, float(FACADE_SVD_GREATEST)) + 0.5));
}

uvec4 svd_factors(FacadeMap map, uint word) { return layer_words4(map.layer, word >> 2); }

uint svd_material(FacadeMap map, uint x, uint y) { return svd_entry(map, svd_factors(map, uint(FACADE_SVD_WORD_MATERIAL)), x, y); }

// The displacement's factors are words 4..7.
uint lookup_svd(FacadeMap map, uint x, uint y) {
    return (svd_entry(map, map.own, x, y) & 0xffffu) | svd_material(map, x, y) << 16;
}

#endif
