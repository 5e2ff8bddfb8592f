// Light on the relief of a facade by its mask (codec/radiance/relief_mask.h): which of the wall's local directions the relief leaves free, around a point
// of it. Written in the common subset of GLSL and C++ (words.glsl). Twin of ReliefMaskView.
#ifndef CITYSTREAM_RELIEF_MASK_GLSL
#define CITYSTREAM_RELIEF_MASK_GLSL

#include "codec/radiance/relief_mask_layout.h"
#include "shaders/facade_ray.glsl"

struct ReliefMask {
    uvec2 layer;
    uint across;  // mask texels
    uint up;
    float side;  // of a mask texel, texels of the map
};

// Masks around a point, and how much each counts: shares add up to 1 with `open`, to which all directions are free.
struct ReliefShares {
    uvec2 bits[4];
    float share[4];
    float open;
};

ReliefMask relief_mask(uvec2 layer) {
    uint map = layer_word(layer, uint(RELIEF_MASK_WORD_MAP));
    uint log2_side = layer_word(layer, uint(RELIEF_MASK_WORD_SIDE)) & 31u;
    return ReliefMask(layer, (((map & 0xffffu) - 1u) >> log2_side) + 1u, (((map >> 16) - 1u) >> log2_side) + 1u, float(1u << log2_side));
}

// A number RELIEF_FACE_* of a hit's normal.
uint relief_face(int axis, float side) {
    if (axis == 2) return uint(RELIEF_FACE_FRONT);
    return uint(axis == 0 ? RELIEF_FACE_RIGHT : RELIEF_FACE_UPPER) + (side < 0.0 ? 1u : 0u);
}

// Of a mask texel's surfaces a point's own, else the one next in depth.
struct ReliefSurface {
    uint word;
    bool is_own;
    float depth;  // millimetres
    float away;   // in depth from the point, millimetres
};

ReliefSurface next_surface(ReliefMask mask, uint texel, float depth, bool is_front) {
    uint word = layer_word(mask.layer, uint(RELIEF_MASK_TEXELS) + texel);
    uint count = word >> uint(RELIEF_MASK_COUNT_SHIFT);
    uint first = word & ((1u << uint(RELIEF_MASK_COUNT_SHIFT)) - 1u);
    uint surface = uint(RELIEF_MASK_TEXELS) + mask.across * mask.up + first * uint(RELIEF_MASK_SURFACE_WORDS);
    ReliefSurface next = ReliefSurface(surface, false, 0.0, 0.0);
    for (uint i = 0u; i < count; ++i) {
        float here = label_depth(layer_word(mask.layer, surface + 2u));
        bool is_own = is_front ? here == depth : here < depth;
        float away = abs(here - depth);
        bool is_better = is_own != next.is_own ? is_own : away < next.away;
        if (i == 0u || is_better) next = ReliefSurface(surface, is_own, here, away);
        surface += uint(RELIEF_MASK_SURFACE_WORDS);
    }
    return next;
}

// `at`: point of the relief in facade space; `label`, `axis`, `side`: of the hit there.
ReliefShares relief_shares(ReliefMask mask, vec3 at, uint label, int axis, float side) {
    bool is_front = axis == 2;
    vec2 place = vec2(at.x, at.y);
    // In front of a reveal, where rays came from.
    if (!is_front) place[axis] = place[axis] + side * 0.5 * mask.side;
    vec2 grid = place / mask.side - vec2(0.5, 0.5);
    vec2 low = floor(grid);
    vec2 part = grid - low;
    float depth = is_front ? label_depth(label) : at.z;
    ReliefShares shares;
    float depths[4];
    float sum = 0.0;
    float nearest = kNever;
    float nearest_share = 0.0;
    uint best = 0u;
    for (uint k = 0u; k < 4u; ++k) {
        bool right = (k & 1u) != 0u;
        bool above = (k & 2u) != 0u;
        uint x = uint(clamp(low.x + (right ? 1.0 : 0.0), 0.0, float(mask.across - 1u)));
        uint y = uint(clamp(low.y + (above ? 1.0 : 0.0), 0.0, float(mask.up - 1u)));
        float share = (right ? part.x : 1.0 - part.x) * (above ? part.y : 1.0 - part.y);
        ReliefSurface next = next_surface(mask, y * mask.across + x, depth, is_front);
        float away = next.away;
        depths[k] = next.depth;
        shares.bits[k] = uvec2(layer_word(mask.layer, next.word), layer_word(mask.layer, next.word + 1u));
        shares.share[k] = next.is_own ? share : 0.0;
        sum += shares.share[k];
        if (away < nearest || (away == nearest && share > nearest_share)) {
            nearest = away;
            nearest_share = share;
            best = k;
        }
    }
    for (uint k = 0u; k < 4u; ++k) {
        float alone = k == best ? 1.0 : 0.0;
        shares.share[k] = sum > 0.0 ? shares.share[k] / sum : alone;
    }
    shares.open = 0.0;
    if (is_front) return shares;
    float foot = 0.0;
    for (uint k = 0u; k < 4u; ++k) foot += shares.share[k] * depths[k];
    float edge = label_depth(label);
    if (edge > foot) shares.open = clamp((at.z - foot) / (edge - foot), 0.0, 1.0);
    for (uint k = 0u; k < 4u; ++k) shares.share[k] *= 1.0 - shares.open;
    return shares;
}

// Mean cosine of a direction to the face's normal.
float relief_weight(ReliefMask mask, uint face, uint direction) {
    uint word = layer_word(mask.layer, uint(RELIEF_MASK_WEIGHTS) + face * uint(RELIEF_MASK_FACE_WORDS) + (direction >> 1));
    return float(word >> (16u * (direction & 1u)) & 0xffffu) * (1.0 / 65536.0);
}

#endif
