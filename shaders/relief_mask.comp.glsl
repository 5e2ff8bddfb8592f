#version 460
// Makes the relief mask of a facade map (codec/radiance/relief_mask.h), a workgroup a surface, a thread a direction. Compiled for each facade renderer.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/relief_passes_layout.h"
#include "shaders/facade_cast.glsl"

layout(local_size_x = RELIEF_MASK_GROUP) in;
layout(push_constant) uniform Constants { ReliefMaskPassConstants constants; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer MaskWords { uint word[]; };

shared uint hidden[2];

// Direction j in facade space, of any length.
vec3 relief_direction(uvec2 mask, uint j) {
    uint word = uint(RELIEF_MASK_DIRECTIONS) + j * uint(RELIEF_MASK_DIRECTION_WORDS);
    uint xy = layer_word(mask, word);
    float z = float(int(layer_word(mask, word + 1u)));
    float across = uintBitsToFloat(layer_word(mask, uint(RELIEF_MASK_WORD_SCALES)));
    float up = uintBitsToFloat(layer_word(mask, uint(RELIEF_MASK_WORD_SCALES + 1)));
    return vec3(label_depth(xy) * across, label_depth(xy >> 16) * up, z * 1000.0);
}

// Whether the relief leaves the direction free above the middle of a texel of the map with this label, which is not open.
bool relief_is_free(FacadeMap map, uvec2 texel, uint label, vec3 direction) {
    // Half a millimetre above the surface: less than any step of the relief.
    vec3 origin = vec3(float(texel.x) + 0.5, float(texel.y) + 0.5, label_depth(label) + 0.5);
    return !cast_facade_ray(map, origin, direction, 0.0, 0.0).hit;
}

void write_word(uvec2 layer, uint index, uint value) {
    if ((layer.x & LAYER_REF_DIRECT) != 0u) {
        MaskWords(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).word[index] = value;
        return;
    }
    MaskWords(PageTable(layer).slot[index >> SLOT_WORDS_LOG2]).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)] = value;
}

void main() {
    uint surface = gl_WorkGroupID.y * uint(RELIEF_PASS_ROW_GROUPS) + gl_WorkGroupID.x;
    if (surface >= constants.surfaces) return;
    FacadeMap map = facade_map(layer_reference(constants.map));
    uvec2 mask = layer_reference(constants.mask);
    uint word = constants.first_word + surface * uint(RELIEF_MASK_SURFACE_WORDS);
    uint start = layer_word(mask, word);
    uint label = layer_word(mask, word + 2u);
    uint direction = gl_LocalInvocationID.x;
    if (direction == 0u) hidden[0] = hidden[1] = 0u;
    barrier();
    uvec2 texel = uvec2(start & 0xffffu, start >> 16);
    // Of a map that is not this caster's nothing is known.
    if (facade_form_is_known(map) && !label_is_open(label) && !relief_is_free(map, texel, label, relief_direction(mask, direction)))
        atomicOr(hidden[direction >> 5], 1u << (direction & 31u));
    barrier();
    if (direction < 2u) write_word(mask, word + direction, ~hidden[direction]);
}
