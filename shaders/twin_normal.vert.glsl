#version 460
// Pulls vertices of 192 or 64 bits and decodes the latter.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/normal_draw_layout.h"
#include "shaders/octahedral.glsl"
#include "shaders/words.glsl"

layout(push_constant) uniform Constants { NormalDraw constants; };

layout(location = 0) out vec3 normal;

void main() {
    WordArray vertices = WordArray(uvec2(constants.vertices[0], constants.vertices[1]));
    uint vertex = uint(gl_VertexIndex);
    vec3 position = vec3(vertex == 1u ? 3.0 : -1.0, vertex == 2u ? 3.0 : -1.0, 0.0);
    normal = vec3(0.0, 0.0, 1.0);
    if (constants.kind == NORMAL_DRAW_FLOATS) {
        uint at = vertex * NORMAL_DRAW_FLOAT_WORDS;
        position = uintBitsToFloat(uvec3(vertices.word[at], vertices.word[at + 1u], vertices.word[at + 2u]));
        normal = uintBitsToFloat(uvec3(vertices.word[at + 3u], vertices.word[at + 4u], vertices.word[at + 5u]));
    } else if (constants.kind == NORMAL_DRAW_PACKED) {
        uint low = vertices.word[vertex * NORMAL_DRAW_PACKED_WORDS], high = vertices.word[vertex * NORMAL_DRAW_PACKED_WORDS + 1u];
        position = vec3(uvec3(low, low >> 16, high) & 0xffffu) * (2.0 / 65535.0) - 1.0;
        normal = unit_direction(unfold_octahedral16(high >> 16));
    }
    gl_Position = vec4(position.xy, position.z * 0.5 + 0.5, 1.0);
}
