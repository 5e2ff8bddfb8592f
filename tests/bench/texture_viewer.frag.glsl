#version 460
// What a viewer without an atlas does with a pixel: the bound texture by the hardware's sampler, lit as ours.
#extension GL_GOOGLE_include_directive : require

#include "shaders/lighting.glsl"

layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 texcoord;
layout(location = 0) out vec4 colour;

layout(set = 0, binding = 0) uniform sampler2D picture;

void main() {
    colour = lit(texture(picture, texcoord).rgb, normalize(normal));
}
