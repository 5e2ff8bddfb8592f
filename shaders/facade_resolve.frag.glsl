#version 460
// Resolve of the keyed facade pass: draws each pixel's nearest hit, where no mesh is nearer.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/draw_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer KeyArray { uvec2 key[]; };

layout(push_constant) uniform Constants { FacadeTableHead head; };

layout(location = 0) out vec4 colour;

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uvec2 key = KeyArray(uvec2(head.keys[0], head.keys[1])).key[pixel.y * head.width + pixel.x];
    if (key.y == 0u) discard;
    gl_FragDepth = uintBitsToFloat(key.y);
    colour = unpackUnorm4x8(key.x);
}
