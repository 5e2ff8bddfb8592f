// The one lighting model, with the constants of client/render/lighting_layout.h.
#ifndef CITYSTREAM_LIGHTING_GLSL
#define CITYSTREAM_LIGHTING_GLSL

#include "client/render/lighting_layout.h"

vec4 lit(vec3 texel, vec3 normal) {
    float sun = max(0.0, dot(normal, vec3(LIGHT_SUN_X, LIGHT_SUN_Y, LIGHT_SUN_Z)));
    return vec4(clamp(texel * (LIGHT_AMBIENT + LIGHT_SUN * sun), 0.0, 1.0), 1.0);
}

#endif
