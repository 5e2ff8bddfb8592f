// From light to a picture's values (client/render/tone_layout.h). Twin of client/render/tone.h.
#ifndef CITYSTREAM_TONE_GLSL
#define CITYSTREAM_TONE_GLSL

#include "client/render/tone_layout.h"

vec3 srgb_decoded(vec3 value) {
    vec3 straight = value * (1.0 / SRGB_SLOPE);
    vec3 curved = pow((value + SRGB_OFFSET) * (1.0 / (1.0 + SRGB_OFFSET)), vec3(SRGB_EXPONENT));
    return mix(curved, straight, lessThanEqual(value, vec3(SRGB_ENCODED_END)));
}

vec3 srgb_encoded(vec3 value) {
    vec3 straight = value * SRGB_SLOPE;
    vec3 curved = (1.0 + SRGB_OFFSET) * pow(max(value, vec3(SRGB_LINEAR_END)), vec3(1.0 / SRGB_EXPONENT)) - SRGB_OFFSET;
    return mix(curved, straight, lessThanEqual(value, vec3(SRGB_LINEAR_END)));
}

vec3 tone(vec3 light) {
    vec3 t = (min(light, vec3(TONE_MOST)) - TONE_LINEAR) * (1.0 / (1.0 - TONE_LINEAR));
    vec3 bent = TONE_LINEAR + (1.0 - TONE_LINEAR) * t / (1.0 + t);
    return mix(bent, light, lessThanEqual(light, vec3(TONE_LINEAR)));
}

// What a pixel shows, sRGB. `light`: radiance times exposure, at least 0.
vec3 shown_light(vec3 light) { return srgb_encoded(tone(light)); }

#endif
