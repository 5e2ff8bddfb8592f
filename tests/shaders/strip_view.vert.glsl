#version 460
// Draws decoded corners: positions of 16 bits a coordinate, pulled by the index.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "tests/shaders/strip_view_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Vertices { uvec2 vertex[]; };
layout(push_constant) uniform Constants { StripViewConstants constants; };
layout(location = 0) out vec3 grid;

float row(uint r, vec4 point) {
    return dot(vec4(constants.clip[r][0], constants.clip[r][1], constants.clip[r][2], constants.clip[r][3]), point);
}

void main() {
    uvec2 words = Vertices(uvec2(constants.vertices[0], constants.vertices[1])).vertex[gl_VertexIndex];
    grid = vec3(words.x & 0xffffu, words.x >> 16, words.y & 0xffffu);
    vec4 point = vec4(grid, 1.0);
    gl_Position = vec4(row(0u, point), row(1u, point), row(2u, point), row(3u, point));
}
