// Where a pixel of the facade pass casts its rays: one through its centre, and where it covers more than the finest parts of its map others
// spread over its area. Written in the common subset of GLSL and C++ (words.glsl).
//
// The samples are a rank-1 lattice about the centre, (i / n, i g / n mod 1): each of n columns and n rows of the pixel holds one, so that edges
// along floors and walls, which most are, come out in n steps of brightness (Sloan and Joe, Lattice Methods for Multiple Integration, 1994).
#ifndef CITYSTREAM_FACADE_SAMPLES_GLSL
#define CITYSTREAM_FACADE_SAMPLES_GLSL

#include "client/render/facade_renderer_layout.h"
#include "shaders/words.glsl"

// Pixels that the finest runs of a map must cover for one ray to do: with fewer their edges come and go as the camera moves.
const float kPixelsPerRun = 2.0;

// Width and height (texels) of what a pixel covers of a plane along the wall that the ray meets at t. `right`, `down`: how the ray changes from
// pixel to pixel.
vec2 facade_footprint(vec3 ray, vec3 right, vec3 down, float t) {
    // Rays along the wall cover it endlessly.
    if (ray.z == 0.0) return vec2(1e30, 1e30);
    vec3 across = right - ray * (right.z / ray.z);
    vec3 up = down - ray * (down.z / ray.z);
    return vec2(abs(t) * (abs(across.x) + abs(up.x)), abs(t) * (abs(across.y) + abs(up.y)));
}

// 1 or `most`. `finest`: width and height of the map's finest runs, texels.
uint facade_sample_count(vec2 footprint, vec2 finest, uint most) {
    bool resolved = footprint.x * kPixelsPerRun <= finest.x && footprint.y * kPixelsPerRun <= finest.y;
    return resolved ? 1u : most;
}

// Place of a sample in pixels from the centre, within half a pixel; sample 0 is the centre. `count`: 1, 5 or 13.
vec2 facade_sample_offset(uint i, uint count) {
    uint generator = count == uint(FACADE_SAMPLES) ? 2u : 5u;
    float x = float(i) / float(count);
    float y = float(i * generator % count) / float(count);
    return vec2(x > 0.5 ? x - 1.0 : x, y > 0.5 ? y - 1.0 : y);
}

#endif
