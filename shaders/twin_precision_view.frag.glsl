#version 460
// Blinn-Phong in grey, lit from one side.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require

#include "client/render/twin_layout.h"

layout(push_constant) uniform Constants { TwinViewConstants constants; };

layout(location = 0) in vec3 normal;
layout(location = 1) in vec3 from_camera;
layout(location = 0) out vec4 colour;

void main() {
    vec3 n = normalize(normal);
    vec3 light = normalize(vec3(0.5, -0.6, 0.62));
    vec3 half_way = normalize(light - normalize(from_camera));
    float diffuse = max(dot(n, light), 0.0);
    float highlight = pow(max(dot(n, half_way), 0.0), constants.shininess);
    colour = vec4(vec3(0.05 + 0.55 * diffuse + 0.4 * highlight), 1.0);
}
