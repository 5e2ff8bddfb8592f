#version 460
// Mesh pass: pulls and decodes one corner of a packed triangle. FRAME_LIGHT: for a frame with a light; SHADOW_PASS: its depth, seen from the sun.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_tint.glsl"
#include "shaders/mesh_corner.glsl"
#include "shaders/page_corner.glsl"
#include "shaders/tile_chart.glsl"

#ifndef SHADOW_PASS
layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 texcoord;
layout(location = 2) flat out uvec3 chart_place;  // of the triangle's chart: layer, finest mip; PageSurface.place
layout(location = 3) flat out uvec4 chart_words;  // the rest of it
layout(location = 4) out float tint;              // place in the palette
#ifdef FRAME_LIGHT
layout(location = 5) out vec3 place;  // grid units from the tile's origin
#endif
#endif

// Whether the pipeline draws prisms by vertices that the triangles of walls share.
bool draws_shared() { return kMeshForm != MESH_FORM_ANY && (kMeshForm & MESH_FORM_SHARED) != 0u; }

MeshCorner shown_corner(uvec2 mesh, MeshDrawConstants draw, uint vertex, ivec3 origin) {
    MeshView view = MeshView(origin, constants.tile.distance_per_unit, constants.tile.least_dropped);
    if (draws_shared()) return mesh_prism_corner(mesh, draw, mesh_prism_of_shared(draw, vertex), view);
    if (kMeshForm == MESH_FORM_ANY || mesh_kind(draw) != uint(RESIDENT_KIND_STRIP_CODE)) return mesh_corner(mesh, draw, vertex, view);
    return mesh_surface_corner(mesh, draw, vertex, WordArray(layer_reference(draw.corners)).word[vertex], view);
}

// Corner of the range.
uint corner_of_vertex(MeshDrawConstants draw, uint vertex) {
    if (!draws_shared()) return vertex;
    MeshPrismCorner corner = mesh_prism_of_shared(draw, vertex);
    return 3u * (corner.prism * draw.triangles + corner.triangle) + corner.k;
}

#ifndef SHADOW_PASS
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
#endif

void main() {
    uvec2 mesh = layer_reference(constants.tile.mesh);
    MeshDrawConstants draw = MeshDrawRecord(layer_reference(constants.tile.mesh_draw)).draw;
    uint vertex = uint(gl_VertexIndex);
    ivec3 origin = tile_origin();
    MeshCorner shown = shown_corner(mesh, draw, vertex, origin);
    vec3 metres = camera_relative_metres(origin + shown.position);
    gl_Position = project(metres);
#ifndef SHADOW_PASS
#ifdef FRAME_LIGHT
    place = vec3(shown.position);
#endif
    tint = kFacadeTint > 0.0 ? tint_place(metres) : 0.0;
    normal = normalize(vec3(shown.normal));

    texcoord = vec2(0.0);
    chart_place = uvec3(0u);
    chart_words = uvec4(0u);
    if (mesh_form_is_flat()) {
        show_colour(layer_word(mesh, shown.chart_entry + RESIDENT_CHART_WORD) & CHART_WORD_COLOUR_MASK);
    } else if (kPages) {
        PageCorner paged = page_corner(mesh, draw, corner_of_vertex(draw, vertex), shown);
        texcoord = paged.place;
        chart_place = paged.surface.place;
        chart_words = paged.surface.frame;
    } else {
        AtlasChart chart = tile_chart(layer_word(mesh, shown.chart_entry + RESIDENT_CHART_WORD));
        bvec2 repeats = bvec2((chart.flags & ATLAS_CHART_REPEAT_U) != 0u, (chart.flags & ATLAS_CHART_REPEAT_V) != 0u);
        texcoord = mesh_place(mesh, draw, shown, repeats);
        show_chart(chart);
    }
#endif
}
