// Tints of walls, by where in the city they stand. Twin of tint_at in codec/atlas/facade_tint.h with the palette of codec/atlas/tint_layout.h.
#ifndef CITYSTREAM_FACADE_TINT_GLSL
#define CITYSTREAM_FACADE_TINT_GLSL

#include "codec/atlas/tint_layout.h"
#include "shaders/draw_constants.glsl"

// How much walls are tinted, 0..1; 0: pipelines without tint.
layout(constant_id = FACADE_TINT_CONSTANT) const float kFacadeTint = 0.0;
layout(constant_id = TINTS_PER_METRE_CONSTANT) const float kTintsPerMetre = 0.0;

#define TINT(red, green, blue) vec3(red, green, blue)
const vec3 kTintPalette[TINT_COLOURS] = vec3[TINT_COLOURS](TINT_PALETTE);
#undef TINT

// Where in the palette a place is, which may be beyond its ends. metres: from the camera.
float tint_place(vec3 metres) { return constants.frame.tint + (metres.x + metres.y) * kTintsPerMetre; }

vec3 tinted(vec3 texel, vec3 normal, float place) {
    if (kFacadeTint <= 0.0 || abs(normal.z) > 0.5) return texel;
    float in_palette = place - floor(place * (1.0 / float(TINT_COLOURS))) * float(TINT_COLOURS);
    int first = min(int(in_palette), TINT_COLOURS - 1);
    vec3 tint = mix(kTintPalette[first], kTintPalette[(first + 1) % TINT_COLOURS], in_palette - float(first));
    return texel * mix(vec3(1.0), tint, kFacadeTint);
}

#endif
