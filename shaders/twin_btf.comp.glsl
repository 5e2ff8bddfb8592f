#version 460
// Twin of BtfView's lookups.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/btf.glsl"
#include "shaders/twin_records.glsl"

float input_float(uint at) { return uintBitsToFloat(twin_input().word[at]); }
vec3 input_vector(uint at) { return vec3(input_float(at), input_float(at + 1u), input_float(at + 2u)); }

void main() {
    uint lookup = gl_GlobalInvocationID.x;
    if (lookup >= constants.count) return;
    uint from = lookup * TWIN_BTF_INPUT_WORDS;
    Btf btf = btf_at(layer_reference(constants.layer));
    BtfPlace place = btf_place(btf, vec2(input_float(from), input_float(from + 1u)), input_vector(from + 2u), twin_input().word[from + 8u]);
    TwinOutput target = twin_output();
    uint to = lookup * TWIN_BTF_WORDS;
    BtfSixteen slots = btf_slot_shares(btf, place);
    for (uint group = 0u; group < 4u; ++group) {
        BtfSixteen values = btf_values(btf, place, group);
        for (uint i = 0u; i < 16u; ++i) target.word[to + 16u * group + i] = floatBitsToUint(values.four[i >> 2][i & 3u]);
        for (uint i = 0u; i < 4u; ++i) target.word[to + 64u + 4u * group + i] = floatBitsToUint(slots.four[group][i]);
    }
    target.word[to + 80u] = floatBitsToUint(btf_coverage(btf, place));
    target.word[to + 81u] = floatBitsToUint(btf_sun_cosine(btf, place, input_vector(from + 5u)));
    target.word[to + 82u] = btf.slots;
    target.word[to + 83u] = floatBitsToUint(btf_openness(btf, place));
}
