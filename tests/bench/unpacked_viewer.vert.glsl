#version 460
// What a renderer without codecs does with a corner: attributes as they are. Out goes what shaders/mesh.vert.glsl gives to its fragments.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/tile_chart.glsl"

layout(location = 0) in vec3 position;  // metres from the tile's origin
layout(location = 1) in vec3 normal_in;
layout(location = 2) in uint colour;

layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 texcoord;
layout(location = 2) flat out uvec3 chart_place;
layout(location = 3) flat out uvec4 chart_words;
layout(location = 4) out float tint;

void main() {
    gl_Position = project(camera_relative_metres(tile_origin()) + position);
    normal = normal_in;
    texcoord = vec2(0.0);
    AtlasChart chart = flat_chart(colour);
    chart_place = uvec3(chart.atlas, floatBitsToUint(chart.finest_mip));
    chart_words = uvec4(chart.index, chart.size, chart.flags, chart.mip_table);
    tint = 0.0;
}
