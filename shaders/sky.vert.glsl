#version 460
// Sky pass: one triangle over the whole picture, infinitely far.
#extension GL_GOOGLE_include_directive : require

#include "client/render/light_layout.h"

layout(push_constant) uniform Constants { SkyConstants sky; };

layout(location = 0) out vec3 ray;

vec3 row_of(float v[3]) { return vec3(v[0], v[1], v[2]); }

void main() {
    vec2 at = vec2(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0);
    vec3 x = row_of(sky.clip_x);
    vec3 y = row_of(sky.clip_y);
    vec3 w = row_of(sky.clip_w);
    ray = w / dot(w, w) + x * (at.x / dot(x, x)) + y * (at.y / dot(y, y));
    gl_Position = vec4(at, 0.0, 1.0);
}
