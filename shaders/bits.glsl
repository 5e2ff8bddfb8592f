// The bit fields in a layer's words. Twin of codec/bits/bit_stream.h.
#ifndef CITYSTREAM_BITS_GLSL
#define CITYSTREAM_BITS_GLSL

#include "shaders/words.glsl"

// Field of `bits` (0..32) bits that starts `bit` bits after word `base`.
uint read_bits(uvec2 layer, uint base, uint bit, uint bits) {
    if (bits == 0u) return 0u;
    uint index = base + (bit >> 5);
    uint shift = bit & 31u;
    uint value = layer_word(layer, index) >> shift;
    if (shift + bits > 32u) value |= layer_word(layer, index + 1u) << (32u - shift);
    return bits == 32u ? value : value & ((1u << bits) - 1u);
}

#endif
