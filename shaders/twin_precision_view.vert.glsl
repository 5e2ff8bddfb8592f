#version 460
// Draws a precision buffer as a vertex shader of a frame would: fetch, the rule that closes cracks, projection.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/twin_layout.h"
#include "shaders/precision_fetch.glsl"

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Normals { float value[]; };

layout(push_constant) uniform Constants { TwinViewConstants constants; };

layout(location = 0) out vec3 normal;
layout(location = 1) out vec3 from_camera;

vec3 vec3_of(float v[3]) { return vec3(v[0], v[1], v[2]); }

void main() {
    uint vertex = uint(gl_VertexIndex);
    PrecisionVertex fetched = precision_fetch3(layer_reference(constants.buffer_words), vertex);
    ivec3 origin = ivec3(constants.from_camera[0], constants.from_camera[1], constants.from_camera[2]);
    ivec3 shown = precision_shown(fetched, origin, origin, constants.common_dropped, constants.distance_per_unit, constants.reading);
    from_camera = vec3(shown) * (1.0 / 1024.0) - vec3_of(constants.frame.camera_fraction);
    gl_Position = vec4(dot(vec3_of(constants.frame.clip_x), from_camera), dot(vec3_of(constants.frame.clip_y), from_camera),
                       constants.frame.near_plane, dot(vec3_of(constants.frame.clip_w), from_camera));
    Normals normals = Normals(uvec2(constants.normals[0], constants.normals[1]));
    normal = vec3(normals.value[3u * vertex], normals.value[3u * vertex + 1u], normals.value[3u * vertex + 2u]);
}
