// How much of the sun reaches a point, by the shadow maps of client/render/shadow_maps.h.
#ifndef CITYSTREAM_SUN_SHADOW_GLSL
#define CITYSTREAM_SUN_SHADOW_GLSL

#include "shaders/light_record.glsl"

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer ShadowDepths { float depth[]; };

// Texels that a point is moved off its surface, per sine of the angle between normal and sun: as far as the filter
// reaches, so that a surface does not shade itself.
const float kShadowOffset = 1.5;
// Texels of a cascade's rim that are not used: as far as the filter and the offset reach.
const float kShadowRim = 3.0;

// Quadratic B-spline over 3 x 3 texels: no steps where the camera or the sun moves. `at`: texels, texels, depth.
float shadow_filtered(LightRecord record, uvec2 depths, vec3 at) {
    ivec2 centre = ivec2(floor(at.xy));
    vec2 f = at.xy - vec2(centre) - 0.5;
    vec2 lower = 0.5 * (0.5 - f) * (0.5 - f);
    vec2 upper = 0.5 * (0.5 + f) * (0.5 + f);
    vec3 across = vec3(lower.x, 1.0 - lower.x - upper.x, upper.x);
    vec3 up = vec3(lower.y, 1.0 - lower.y - upper.y, upper.y);
    ShadowDepths map = ShadowDepths(depths);
    int side = int(record.light.shadow_side);
    float sum = 0.0;
    for (int j = 0; j < 3; ++j) {
        int row = (centre.y + j - 1) * side + centre.x - 1;
        for (int i = 0; i < 3; ++i) sum += map.depth[row + i] > at.z ? 0.0 : across[i] * up[j];
    }
    return sum;
}

// `metres`: from the camera; `normal`: of the surface, a unit vector that faces the sun.
float sun_share(LightRecord record, vec3 metres, vec3 normal) {
    vec3 to_sun = light_vec3(record.light.to_sun);
    float side = float(record.light.shadow_side);
    float sine = length(cross(normal, to_sun));
    vec3 at = vec3(0.0);
    uvec2 depths = uvec2(0u);
    // Of the first cascade that has the point.
    for (uint i = 0u; i < record.light.cascades; ++i) {
        ShadowCascade cascade = record.light.cascade[i];
        vec4 moved = vec4(metres + cascade.texel_metres * (normal * (kShadowOffset * sine) + to_sun * 0.5), 1.0);
        at = vec3(dot(vec4(cascade.column[0], cascade.column[1], cascade.column[2], cascade.column[3]), moved),
                  dot(vec4(cascade.row[0], cascade.row[1], cascade.row[2], cascade.row[3]), moved),
                  dot(vec4(cascade.depth[0], cascade.depth[1], cascade.depth[2], cascade.depth[3]), moved));
        if (all(greaterThan(at.xy, vec2(kShadowRim))) && all(lessThan(at.xy, vec2(side - kShadowRim)))) {
            depths = uvec2(cascade.depths[0], cascade.depths[1]);
            break;
        }
    }
    return depths == uvec2(0u) ? 1.0 : shadow_filtered(record, depths, at);
}

#endif
