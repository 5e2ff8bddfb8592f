#version 460
// Twin of codec/mesh/octahedral.h and octahedral_hemisphere.h: reads codes and makes them.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/octahedral.glsl"
#include "shaders/twin_records.glsl"

void main() {
    uint item = gl_GlobalInvocationID.x;
    if (item >= constants.count) return;
    uint at = item * TWIN_NORMAL_INPUT_WORDS;
    WordArray source = twin_input();
    uvec2 code = uvec2(source.word[at], source.word[at + 1u]);
    vec3 n = uintBitsToFloat(uvec3(source.word[at + 2u], source.word[at + 3u], source.word[at + 4u]));
    uint bits = constants.first, written_bits = min(bits, 22u);
    ivec3 unfolded = unfold_octahedral(code, bits);
    uvec3 unit = floatBitsToUint(unit_direction(unfolded));
    ivec3 upper = unfold_hemisphere(code, bits);
    uvec2 rounded = pack_octahedral_rounded(n, written_bits);
    uvec2 nearest = pack_octahedral(n, written_bits);
    uvec2 hemisphere = pack_hemisphere_rounded(n, written_bits);
    uint words[TWIN_NORMAL_WORDS] =
        uint[](uint(unfolded.x), uint(unfolded.y), uint(unfolded.z), unit.x, unit.y, unit.z, uint(upper.x), uint(upper.y), uint(upper.z),
               rounded.x, rounded.y, nearest.x, nearest.y, hemisphere.x, hemisphere.y, 0u);
    TwinOutput target = twin_output();
    for (uint i = 0u; i < TWIN_NORMAL_WORDS; ++i) target.word[item * TWIN_NORMAL_WORDS + i] = words[i];
}
