#version 460
// Mesh pass: pulls and decodes one corner of a packed triangle.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_tint.glsl"
#include "shaders/mesh_corner.glsl"
#include "shaders/page_corner.glsl"
#include "shaders/tile_chart.glsl"

layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 texcoord;
layout(location = 2) flat out uvec3 chart_place;  // of the triangle's chart: layer, finest mip; PageSurface.place
layout(location = 3) flat out uvec4 chart_words;  // the rest of it
layout(location = 4) out float tint;              // place in the palette

MeshCorner shown_corner(uvec2 mesh, uint range, uint corner, ivec3 origin) {
    TileConstants tile = constants.tile;
    if (kMeshForm == MESH_FORM_ANY || (kMeshForm & 255u) != uint(RESIDENT_KIND_STRIP_CODE)) return mesh_corner(mesh, range, corner, origin, tile.distance_per_unit, tile.least_dropped);
    uint vertex = WordArray(uvec2(tile.corners[0], tile.corners[1])).word[corner];
    return mesh_corner_of_vertex(mesh, range, corner, vertex, origin, tile.distance_per_unit, tile.least_dropped);
}

void show_chart(AtlasChart chart) {
    chart_place = uvec3(chart.atlas, floatBitsToUint(chart.finest_mip));
    chart_words = uvec4(chart.index, chart.size, chart.flags, chart.mip_table);
}

void show_colour(uint colour) {
    if (kPages) {
        PageSurface surface = flat_surface(colour);
        chart_place = surface.place;
        chart_words = surface.frame;
    } else {
        show_chart(flat_chart(colour));
    }
}

void main() {
    uvec2 mesh = layer_reference(constants.tile.mesh);
    uint range = uint(gl_InstanceIndex);
    uint corner = uint(gl_VertexIndex);
    ivec3 origin = tile_origin();
    MeshCorner shown = shown_corner(mesh, range, corner, origin);
    vec3 metres = camera_relative_metres(origin + shown.position);
    gl_Position = project(metres);
    tint = kFacadeTint > 0.0 ? tint_place(metres) : 0.0;
    normal = normalize(vec3(shown.normal));

    texcoord = vec2(0.0);
    chart_place = uvec3(0u);
    chart_words = uvec4(0u);
    if (mesh_form_is_flat()) {
        show_colour(layer_word(mesh, shown.chart_entry + RESIDENT_CHART_WORD) & CHART_WORD_COLOUR_MASK);
    } else if (kPages) {
        PageCorner paged = page_corner(mesh, range, corner, shown);
        texcoord = paged.place;
        chart_place = paged.surface.place;
        chart_words = paged.surface.frame;
    } else {
        AtlasChart chart = tile_chart(layer_word(mesh, shown.chart_entry + RESIDENT_CHART_WORD));
        bvec2 repeats = bvec2((chart.flags & ATLAS_CHART_REPEAT_U) != 0u, (chart.flags & ATLAS_CHART_REPEAT_V) != 0u);
        texcoord = mesh_place(mesh, shown.chart_entry, shown.texcoord, repeats);
        show_chart(chart);
    }
}
