#version 460
// Mesh pass: the atlas chart, lit.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"
#include "shaders/lighting.glsl"

layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 texcoord;
layout(location = 2) flat in uvec4 chart_words;

layout(location = 0) out vec4 colour;

void main() {
    vec2 dx = dFdx(texcoord);
    vec2 dy = dFdy(texcoord);
    vec3 texel = kUntexturedColour;
    if (has_atlas()) {
        AtlasChart chart = AtlasChart(chart_words.x, chart_words.y, chart_words.z, chart_words.w);
        texel = sample_chart(layer_reference(constants.tile.atlas), chart, constants.tile.atlas_finest_mip, texcoord, dx, dy);
    }
    colour = lit(texel, normalize(normal));
}
