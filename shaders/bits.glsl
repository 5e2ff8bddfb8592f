// The bit fields in a layer's words. Twin of codec/bits/bit_stream.h.
#ifndef CITYSTREAM_BITS_GLSL
#define CITYSTREAM_BITS_GLSL

#include "shaders/words.glsl"

// 32 bits from bit `shift` (0..31) of two words.
uint read_across(uint first, uint second, uint shift) { return first >> shift | second << 1u << (31u - shift); }

// Field of `bits` (0..32) bits that starts `bit` bits after word `base`. Without branches: of the vertices that are shaded together some nearly always
// have a field in two words. A field in one word reads that twice, an empty one the layer's first word: nothing behind the last word is touched.
uint read_bits(uvec2 layer, uint base, uint bit, uint bits) {
    uint shift = bit & 31u;
    uint index = bits == 0u ? 0u : base + (bit >> 5);
    uint value = read_across(layer_word(layer, index), layer_word(layer, index + (shift + bits > 32u ? 1u : 0u)), shift);
    return bits == 0u ? 0u : value & ~0u >> (32u - bits);
}

#endif
