#version 460
// Mesh pass: the atlas chart, lit.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_tint.glsl"
#include "shaders/lighting.glsl"
#include "shaders/page_chart.glsl"

layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 texcoord;
layout(location = 2) flat in uvec3 chart_place;
layout(location = 3) flat in uvec4 chart_words;
layout(location = 4) in float tint;

layout(location = 0) out vec4 colour;

void main() {
    vec2 dx = dFdx(texcoord);
    vec2 dy = dFdy(texcoord);
    vec3 texel;
    if (kPages) {
        texel = sample_surface(PageSurface(chart_place, chart_words), texcoord, dx, dy);
    } else {
        AtlasChart chart =
            AtlasChart(chart_place.xy, uintBitsToFloat(chart_place.z), chart_words.x, chart_words.y, chart_words.z, chart_words.w);
        if (kAlphaTest && has_alpha(chart) && sample_alpha(chart, texcoord, dx, dy) < 0.5) {
            discard;
            return;
        }
        texel = sample_chart(chart, texcoord, dx, dy);
    }
    vec3 towards = normalize(normal);
    colour = lit(tinted(texel, towards, tint), towards);
}
