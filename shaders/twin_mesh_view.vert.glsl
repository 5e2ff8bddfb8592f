#version 460
// Draws a range of a mesh layer as the vertex shader of a frame does: the corner, the rule that closes cracks, projection.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/twin_layout.h"
#include "shaders/mesh_corner.glsl"

layout(push_constant) uniform Constants { TwinMeshViewConstants constants; };

layout(location = 0) out vec3 normal;

vec3 vec3_of(float v[3]) { return vec3(v[0], v[1], v[2]); }

void main() {
    ivec3 tile = ivec3(constants.from_camera[0], constants.from_camera[1], constants.from_camera[2]);
    MeshView view = MeshView(tile, constants.distance_per_unit, constants.least_dropped);
    MeshCorner corner =
        mesh_corner(layer_reference(constants.mesh), MeshDrawRecord(layer_reference(constants.draw)).draw, uint(gl_VertexIndex), view);
    vec3 from_camera = vec3(tile + corner.position) * (1.0 / 1024.0) - vec3_of(constants.frame.camera_fraction);
    gl_Position = vec4(dot(vec3_of(constants.frame.clip_x), from_camera), dot(vec3_of(constants.frame.clip_y), from_camera),
                       constants.frame.near_plane, dot(vec3_of(constants.frame.clip_w), from_camera));
    normal = vec3(corner.normal);
}
