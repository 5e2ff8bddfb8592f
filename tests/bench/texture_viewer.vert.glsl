#version 460
// What a viewer without an atlas does with a corner: attributes as they are.
#extension GL_GOOGLE_include_directive : require

#include "tests/bench/texture_viewer_layout.h"

layout(location = 0) in vec3 position;  // metres from the city's corner
layout(location = 1) in vec3 normal_in;
layout(location = 2) in vec2 texcoord_in;

layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 texcoord;

layout(push_constant) uniform Constants {
    PlainConstants constants;
};

vec3 vec3_of(float v[3]) {
    return vec3(v[0], v[1], v[2]);
}

void main() {
    vec3 metres = position + vec3_of(constants.corner);
    gl_Position = vec4(dot(vec3_of(constants.clip_x), metres), dot(vec3_of(constants.clip_y), metres),
                       constants.near_plane, dot(vec3_of(constants.clip_w), metres));
    normal = normal_in;
    texcoord = texcoord_in;
}
