#version 460
// Twin of MeshLayerView: decodes every corner of a mesh layer to words.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/mesh_fetch.glsl"
#include "shaders/twin_records.glsl"

void main() {
    uint corner = gl_GlobalInvocationID.x;
    if (corner >= constants.count) return;
    uvec2 mesh = layer_reference(constants.layer);
    uint widths = layer_word(mesh, MESH_WORD_WIDTHS);
    uint vertex = mesh_index(mesh, widths, corner);
    uint entry = mesh_chart_entry(mesh, widths, corner / 3u);
    uint code = mesh_packed_normal(mesh, vertex);
    ivec3 position = mesh_position(mesh, widths, constants.first, constants.mesh_step_begin, vertex);
    ivec3 normal = unfold_octahedral16(code);
    ivec2 texcoord = mesh_texcoord(mesh, entry, vertex);
    uint words[TWIN_MESH_WORDS] = uint[](vertex, uint(position.x), uint(position.y), uint(position.z), code, uint(normal.x),
                                         uint(normal.y), uint(normal.z), uint(texcoord.x), uint(texcoord.y),
                                         layer_word(mesh, entry + MESH_CHART_WORD), 0u);
    TwinOutput target = twin_output();
    for (uint i = 0u; i < TWIN_MESH_WORDS; ++i) target.word[corner * TWIN_MESH_WORDS + i] = words[i];
}
