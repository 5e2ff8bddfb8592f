// What the passes that make BTFs share: their constants, and how they write words.
#ifndef CITYSTREAM_BTF_WORDS_GLSL
#define CITYSTREAM_BTF_WORDS_GLSL

#include "client/render/relief_passes_layout.h"
#include "shaders/btf.glsl"

layout(local_size_x = BTF_GROUP) in;
layout(push_constant) uniform Constants { BtfPassConstants constants; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer BtfWords { uint word[]; };

void write_word(uint index, uint value) {
    uvec2 btf = layer_reference(constants.btf);
    BtfWords(uvec2(btf.x ^ LAYER_REF_DIRECT, btf.y)).word[index] = value;
}

uint packed(uvec4 bytes) { return bytes.x | bytes.y << 8 | bytes.z << 16 | bytes.w << 24; }

#endif
