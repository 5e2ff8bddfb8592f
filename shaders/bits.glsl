// Words of layers in GPU memory and the bit fields in them. Twin of codec/bits/bit_stream.h.
#ifndef CITYSTREAM_BITS_GLSL
#define CITYSTREAM_BITS_GLSL

#include "client/render/draw_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer WordArray { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer PageTable { uvec2 slot[]; };

uvec2 layer_reference(uint reference[2]) { return uvec2(reference[0], reference[1]); }

// One word of a layer. A layer in one piece is read straight, any other through its page table.
uint layer_word(uvec2 layer, uint index) {
    if ((layer.x & LAYER_REF_DIRECT) != 0u) return WordArray(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).word[index];
    uvec2 slot = PageTable(layer).slot[index >> SLOT_WORDS_LOG2];
    return WordArray(slot).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)];
}

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
