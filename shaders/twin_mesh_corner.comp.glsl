#version 460
// Twin of ResidentMeshView: decodes every corner of a range of a resident mesh to words.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/mesh_corner.glsl"
#include "shaders/twin_records.glsl"

void main() {
    uint corner = gl_GlobalInvocationID.x;
    if (corner >= constants.count) return;
    uvec2 mesh = layer_reference(constants.layer);
    WordArray view = twin_input();
    MeshDrawConstants draw = MeshDrawRecord(layer_reference(constants.draw)).draw;
    MeshView from = MeshView(ivec3(view.word[0], view.word[1], view.word[2]), view.word[3], view.word[4]);
    MeshCorner shown;
    if (mesh_kind(draw) == uint(RESIDENT_KIND_STRIP_CODE))
        shown = mesh_surface_corner(mesh, draw, corner, WordArray(layer_reference(draw.corners)).word[corner], from);
    else
        shown = mesh_corner(mesh, draw, corner, from);
    ivec2 texcoord = mesh_texcoord(mesh, draw, shown);
    uint words[TWIN_CORNER_WORDS] =
        uint[](uint(shown.position.x), uint(shown.position.y), uint(shown.position.z), uint(shown.normal.x), uint(shown.normal.y),
               uint(shown.normal.z), shown.chart_entry, shown.texcoord, uint(texcoord.x), uint(texcoord.y));
    TwinOutput target = twin_output();
    for (uint i = 0u; i < TWIN_CORNER_WORDS; ++i) target.word[corner * TWIN_CORNER_WORDS + i] = words[i];
}
