#version 460
// Twin of codec/atlas/wrap_coordinate.h: decodes packed coordinates, and wraps a place in the chart that each names.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/twin_records.glsl"
#include "shaders/wrap_coordinate.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= constants.count) return;
    WordArray from = twin_input();
    uint word = i * uint(TWIN_WRAP_INPUT_WORDS);
    uvec2 packed = uvec2(from.word[word], from.word[word + 1u]);
    uint border_and_clamps = from.word[word + 2u];
    vec2 place = vec2(uintBitsToFloat(from.word[word + 3u]), uintBitsToFloat(from.word[word + 4u]));
    vec4 frame = wrap_frame(packed, border_and_clamps & 255u);
    vec2 own_place = wrap_place(packed);
    vec4 shown = frame;
    if ((border_and_clamps >> 8 & 1u) != 0u) shown.z = -shown.z;
    if ((border_and_clamps >> 9 & 1u) != 0u) shown.w = -shown.w;
    vec2 texel = wrap_texel(shown, place, uintBitsToFloat(from.word[word + 5u]));
    float values[TWIN_WRAP_WORDS] = float[](frame.x, frame.y, frame.z, frame.w, own_place.x, own_place.y, texel.x, texel.y);
    for (uint k = 0u; k < uint(TWIN_WRAP_WORDS); ++k) twin_output().word[i * uint(TWIN_WRAP_WORDS) + k] = floatBitsToUint(values[k]);
}
