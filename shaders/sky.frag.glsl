#version 460
// Sky pass: the environment and the sun's disc, where nothing was drawn.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/environment.glsl"
#include "shaders/tone.glsl"

layout(push_constant) uniform Constants { SkyConstants sky; };

layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 colour;

void main() {
    LightRecord record = LightRecord(uvec2(sky.light[0], sky.light[1]));
    vec3 light = environment_light(record, ray);
    // A pixel at the disc's rim shows the part of it that is covered, and nothing of it is seen through the ground.
    float off = distance(normalize(ray), light_vec3(record.light.to_sun));
    float covered = (record.light.disc_radius - off) * length(ray) / sky.pixel + 0.5;
    covered = min(covered, ray.z / sky.pixel + 0.5);
    light += light_vec3(record.light.disc) * clamp(covered, 0.0, 1.0);
    colour = vec4(shown_light(light), 1.0);
}
