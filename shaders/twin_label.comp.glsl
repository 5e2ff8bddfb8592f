#version 460
// Twin of the maps' lookups: labels of texels (input: x | y << 16 each). Compiled for each facade renderer.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_cast.glsl"
#include "shaders/twin_records.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= constants.count) return;
    uint texel = twin_input().word[i];
    twin_output().word[i] = facade_label(facade_map(layer_reference(constants.layer)), texel & 0xffffu, texel >> 16);
}
