// The environment map of a frame's light. Twin of EnvironmentMap::radiance in client/light/environment_map.h.
#ifndef CITYSTREAM_ENVIRONMENT_GLSL
#define CITYSTREAM_ENVIRONMENT_GLSL

#include "shaders/light_record.glsl"

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer MapTexelArray { uint texel[]; };

// Three 9-bit fractions and an exponent (client/render/map_texels.h).
vec3 unpack_shared_exponent(uint word) {
    return vec3(uvec3(word, word >> 9, word >> 18) & 511u) * exp2(float(word >> 27) - 24.0);
}

// Of a row and column that may lie one step beyond the edges: a step over a pole goes to the other side of it.
vec3 environment_texel(LightRecord record, int column, int row) {
    int width = int(record.light.map_width);
    int height = int(record.light.map_height);
    if (row < 0 || row >= height) {
        row = row < 0 ? 0 : height - 1;
        column += width / 2;
    }
    column = (column + width) % width;
    MapTexelArray texels = MapTexelArray(uvec2(record.light.map[0], record.light.map[1]));
    return unpack_shared_exponent(texels.texel[row * width + column]);
}

// Shown radiance from a direction of any length but 0.
vec3 environment_light(LightRecord record, vec3 from) {
    const float kPi = 3.14159265358979;
    float level = length(from.xy);
    float turns = (level > 0.0 ? atan(from.x, from.y) : 0.0) / (2.0 * kPi) + 0.5;
    float theta = level > 0.0 ? atan(level, from.z) : from.z < 0.0 ? kPi : 0.0;
    vec2 place = vec2(turns - floor(turns), theta / kPi) * vec2(record.light.map_width, record.light.map_height) - 0.5;
    ivec2 first = ivec2(floor(place));
    vec2 share = place - vec2(first);
    vec3 upper = mix(environment_texel(record, first.x, first.y), environment_texel(record, first.x + 1, first.y), share.x);
    vec3 lower = mix(environment_texel(record, first.x, first.y + 1), environment_texel(record, first.x + 1, first.y + 1), share.x);
    return mix(upper, lower, share.y) * record.light.map_scale;
}

#endif
