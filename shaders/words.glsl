// Where layers lie in GPU memory, and how their words are read. All that reads a layer does so through layer_word and layer_words4.
//
// Casting and lookups of facades (facade_*.glsl but the passes) are written in the common subset of GLSL and C++ with glm, so that
// tests/shaders/glsl_on_cpu.h, which stands in for this file there, can run the same source on the CPU: no swizzles, no arrays of
// unknown size, uint and float never mixed without a constructor, parameters that are written to spelled OUT(type) and INOUT(type).
#ifndef CITYSTREAM_WORDS_GLSL
#define CITYSTREAM_WORDS_GLSL

#include "client/render/draw_layout.h"

#define OUT(type) out type
#define INOUT(type) inout type
// Marks a step of a ray: counted on the CPU.
#define COUNT_STEP()
// The most steps of a ray: tests on the CPU lower it.
#define STEP_BOUND(most) (most)

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer WordArray { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 16) readonly buffer WordGroupArray { uvec4 group[]; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer PageTable { uvec2 slot[]; };

// Set in pipelines that draw only tiles all of whose layers lie in one piece.
layout(constant_id = DIRECT_LAYERS_CONSTANT) const bool kDirectLayers = false;

uvec2 layer_reference(uint reference[2]) { return uvec2(reference[0], reference[1]); }

// One word of a layer. A layer in one piece is read straight, any other through its page table.
uint layer_word(uvec2 layer, uint index) {
    if (kDirectLayers || (layer.x & LAYER_REF_DIRECT) != 0u) return WordArray(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).word[index];
    uvec2 slot = PageTable(layer).slot[index >> SLOT_WORDS_LOG2];
    return WordArray(slot).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)];
}

// Words 4 * group .. 4 * group + 3 in one load: layers begin at multiples of 16 bytes, and slots are whole groups.
// What lies behind the layer's last word is undefined.
uvec4 layer_words4(uvec2 layer, uint group) {
    if (kDirectLayers || (layer.x & LAYER_REF_DIRECT) != 0u) return WordGroupArray(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).group[group];
    uvec2 slot = PageTable(layer).slot[group >> (SLOT_WORDS_LOG2 - 2)];
    return WordGroupArray(slot).group[group & ((1u << (SLOT_WORDS_LOG2 - 2)) - 1u)];
}

#endif
