#version 460
// Writes light, or the direction as a texel of a G-buffer.
#extension GL_GOOGLE_include_directive : require

#include "client/render/normal_draw_layout.h"
#include "shaders/octahedral.glsl"

layout(push_constant) uniform Constants { NormalDraw constants; };

layout(location = 0) in vec3 normal;
layout(location = 0) out vec4 texel;

void main() {
    vec3 n = normal;
    if (constants.kind == NORMAL_DRAW_EXACT) {
        vec2 place = gl_FragCoord.xy / float(constants.height);
        bool behind = place.x >= 1.0;
        vec2 p = vec2(behind ? place.x - 1.0 : place.x, place.y) * 2.0 - 1.0;
        float square = 1.0 - dot(p, p);
        if (square < 0.0) discard;
        n = vec3(p, behind ? -sqrt(square) : sqrt(square));
    }
    if (constants.bits == NORMAL_DRAW_LIGHT) {
        texel = vec4(vec3(max(dot(unit_direction(n), vec3(0.48, 0.6, 0.64)), 0.0)), 1.0);
        return;
    }
    uvec2 code = constants.nearest != 0u ? pack_octahedral(n, constants.bits) : pack_octahedral_rounded(n, constants.bits);
    uvec4 bytes = constants.bits > 8u ? uvec4(code & 255u, code >> 8).xzyw : uvec4(code, 0u, 255u);
    texel = vec4(bytes) / 255.0;
}
