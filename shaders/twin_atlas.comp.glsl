#version 460
// Twin of AtlasLayerView::texel: decodes one mip of a chart, one word (RGBA) a texel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/atlas_sample.glsl"
#include "shaders/twin_records.glsl"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= constants.count) return;
    AtlasChart chart = atlas_chart(layer_reference(constants.layer), constants.first, float(constants.second));
    int width = chart_mip_size(chart, constants.second).x;
    ivec4 texel = chart_texel(chart, constants.second, ivec2(int(i) % width, int(i) / width));
    twin_output().word[i] = uint(texel.r) | uint(texel.g) << 8 | uint(texel.b) << 16 | uint(texel.a) << 24;
}
