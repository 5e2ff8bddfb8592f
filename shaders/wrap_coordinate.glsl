// Charts that lie in a common page: decodes packed chart coordinates, wraps or clamps a place inside its chart, scales gradients.
// Twin of codec/atlas/wrap_coordinate.h (bit for bit, but for wrap_level's logarithm). Written in the common subset of GLSL and C++ (words.glsl).
//
// Vertex shader: frame and place of the corner, by any of the three transports. Fragment shader: frame flat, place interpolated;
//   float level = wrap_level(frame, dFdx(place), dFdy(place), finest, coarsest);
//   textureLod(page, wrap_texel(frame, place, level) * inverse_page_size, level)
// or textureGrad with wrap_gradient(frame, dFdx(place)) * inverse_page_size. Levels above `coarsest` (the page's M) mix charts: never sample them,
// and never with anisotropy. inverse_page_size comes from the CPU, so that a page whose sides are no powers of two gives the same bits everywhere.
#ifndef CITYSTREAM_WRAP_COORDINATE_GLSL
#define CITYSTREAM_WRAP_COORDINATE_GLSL

#include "codec/atlas/wrap_coordinate_layout.h"

// Origin of the interior along an axis, texels of the page.
float wrap_origin(uint word, uint border) { return float((word >> WRAP_ORIGIN_SHIFT) * uint(WRAP_GRID) + border); }

// Size of the interior along an axis, texels. A chart that is all border has none.
float wrap_size(uint word, uint border) {
    uint padded = ((word >> WRAP_SIZE_SHIFT & WRAP_SIZE_MASK) + 1u) * uint(WRAP_GRID);
    return float(padded - min(padded, 2u * border));
}

// Chart frame of a packed coordinate (transport 3): what transports 1 and 2 bring as it is.
vec4 wrap_frame(uvec2 words, uint border) {
    return vec4(wrap_origin(words.x, border), wrap_origin(words.y, border), wrap_size(words.x, border), wrap_size(words.y, border));
}

// Place of a packed coordinate, in repeats; exact.
vec2 wrap_place(uvec2 words) {
    return vec2(float(words.x & WRAP_PLACE_MASK) / float(WRAP_PLACE_ONE), float(words.y & WRAP_PLACE_MASK) / float(WRAP_PLACE_ONE));
}

// Equation 2 along an axis: a place that repeats is wrapped (its border does the rest), any other stays half a texel of the coarser of the two
// levels that `level` lies between away from the ends (in the middle of a chart that is smaller than that).
float wrap_axis(float origin, float size, float place, float level) {
    if (size >= 0.0) return origin + (place - floor(place)) * size;
    float margin = min(0.5 * float(1u << uint(ceil(level))), -0.5 * size);
    return origin + clamp(place * -size, margin, -size - margin);
}

// Where to sample, in texels of the page's finest level.
vec2 wrap_texel(vec4 frame, vec2 place, float level) {
    return vec2(wrap_axis(frame.x, frame.z, place.x, level), wrap_axis(frame.y, frame.w, place.y, level));
}

// Change of the sampled texel with a change of place; from the place before it is wrapped, so that no seam shows. The paper's Algorithm 8 leaves the
// size out, which makes mips too coarse or too fine by the chart's share of the page.
vec2 wrap_gradient(vec4 frame, vec2 change) { return vec2(change.x * abs(frame.z), change.y * abs(frame.w)); }

// OpenGL's isotropic level of detail, clamped to what the page has (0 <= finest <= coarsest).
float wrap_level(vec4 frame, vec2 dx, vec2 dy, float finest, float coarsest) {
    vec2 across = wrap_gradient(frame, dx);
    vec2 up = wrap_gradient(frame, dy);
    float rho_squared = max(dot(across, across), dot(up, up));
    return clamp(0.5 * log2(max(rho_squared, 1e-12)), finest, coarsest);
}

#endif
