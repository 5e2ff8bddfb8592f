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
    ivec3 from_camera = ivec3(view.word[0], view.word[1], view.word[2]);
    MeshCorner shown;
    if (constants.second == 1u)
        shown = mesh_corner_of_vertex(mesh, constants.first, corner, view.word[TWIN_CORNER_INPUT_WORDS + corner], from_camera, view.word[3], view.word[4]);
    else
        shown = mesh_corner(mesh, constants.first, corner, from_camera, view.word[3], view.word[4]);
    ivec2 texcoord = mesh_texcoord(mesh, shown.chart_entry, shown.texcoord);
    uint words[TWIN_CORNER_WORDS] =
        uint[](uint(shown.position.x), uint(shown.position.y), uint(shown.position.z), uint(shown.normal.x), uint(shown.normal.y),
               uint(shown.normal.z), shown.chart_entry, shown.texcoord, uint(texcoord.x), uint(texcoord.y));
    TwinOutput target = twin_output();
    for (uint i = 0u; i < TWIN_CORNER_WORDS; ++i) target.word[corner * TWIN_CORNER_WORDS + i] = words[i];
}
