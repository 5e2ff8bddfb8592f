#version 460
// Mesh pass: pulls and decodes one corner of a packed triangle.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_tint.glsl"
#include "shaders/mesh_fetch.glsl"
#include "shaders/page_corner.glsl"
#include "shaders/tile_chart.glsl"

layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 texcoord;
layout(location = 2) flat out uvec3 chart_place;  // of the triangle's chart: layer, finest mip; PageSurface.place
layout(location = 3) flat out uvec4 chart_words;  // the rest of it
layout(location = 4) out float tint;              // place in the palette

void main() {
    uvec2 mesh = layer_reference(constants.tile.mesh);
    uint widths = layer_word(mesh, MESH_WORD_WIDTHS);
    uint corner = uint(gl_VertexIndex);
    uint vertex = mesh_index(mesh, widths, corner);

    ivec3 position = mesh_position(mesh, widths, constants.tile.mesh_steps, constants.tile.mesh_step_begin, vertex);
    ivec3 origin = tile_origin();
    vec3 metres = camera_relative_metres(origin + position);
    gl_Position = project(metres);
    tint = kFacadeTint > 0.0 ? tint_place(metres) : 0.0;
    normal = normalize(vec3(unfold_octahedral16(mesh_packed_normal(mesh, vertex))));

    texcoord = vec2(0.0);
    chart_place = uvec3(0u);
    chart_words = uvec4(0u);
    if (kPages) {
        PageCorner shown = page_corner(mesh, widths, corner, vertex);
        texcoord = shown.place;
        chart_place = shown.surface.place;
        chart_words = shown.surface.frame;
    } else {
        uint entry = mesh_chart_entry(mesh, widths, corner / 3u);
        AtlasChart chart = tile_chart(layer_word(mesh, entry + MESH_CHART_WORD));
        bvec2 repeats = bvec2((chart.flags & ATLAS_CHART_REPEAT_U) != 0u, (chart.flags & ATLAS_CHART_REPEAT_V) != 0u);
        texcoord = mesh_place(mesh, entry, vertex, repeats);
        chart_place = uvec3(chart.atlas, floatBitsToUint(chart.finest_mip));
        chart_words = uvec4(chart.index, chart.size, chart.flags, chart.mip_table);
    }
}
