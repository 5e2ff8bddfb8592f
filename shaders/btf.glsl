// Lookups in a facade's bidirectional texture function (codec/radiance/btf.h). Written in the common subset of GLSL and C++ (words.glsl). Twin of
// BtfView. Words are read in aligned groups of four.
#ifndef CITYSTREAM_BTF_GLSL
#define CITYSTREAM_BTF_GLSL

#include "codec/radiance/btf_layout.h"
#include "shaders/words.glsl"

struct Btf {
    uvec2 layer;
    uint patch_log2;
    uint views_across;
    uint texels_a_view;
    uint slots;     // palette slots that the map uses, a bit each
    uint records;   // word
    uint coverage;  // word; 0: all is covered
};

// Four directions of a grid around one; shares add up to 1.
struct SphereShares {
    uint cell[4];
    float share[4];
};

// Four texels of four views; shares add up to 1.
struct BtfPlace {
    uint record[16];
    float share[16];
};

// Of 16 directions, or of 16 palette slots.
struct BtfSixteen {
    vec4 four[4];
};

Btf btf_at(uvec2 layer) {
    uvec4 head = layer_words4(layer, 0u);
    uvec4 more = layer_words4(layer, 1u);
    uint shape = head.y;
    uint patch_log2 = shape & 31u;
    uint side_texels = 1u << (2u * patch_log2);
    // All mips have (4 n - 1) / 3 texels, filled up to a multiple of four.
    uint texels = ((4u * side_texels - 1u) / 3u + 3u) & ~3u;
    return Btf(layer, patch_log2, shape >> 8 & 255u, texels, head.z, more.x, more.y);
}

vec3 btf_table_direction(uvec2 layer, uint table, uint index) {
    uvec4 words = layer_words4(layer, (table >> 2) + index);
    return vec3(uintBitsToFloat(words.x), uintBitsToFloat(words.y), uintBitsToFloat(words.z));
}

// Place of a unit direction with z >= 0 in Shirley and Chiu's square, 0..1.
vec2 hemisphere_square(vec3 d) {
    float r = sqrt(max(1.0 - d.z, 0.0));
    float kEighthTurns = 1.2732395447;  // 4 / pi
    bool is_x = abs(d.x) > abs(d.y);
    float major = is_x ? d.x : d.y;
    float minor = is_x ? d.y : d.x;
    if (major == 0.0) return vec2(0.5, 0.5);
    float along = major < 0.0 ? -r : r;
    float across = along * atan(minor / major) * kEighthTurns;
    return vec2(0.5, 0.5) + 0.5 * (is_x ? vec2(along, across) : vec2(across, along));
}

float triple_product(vec3 a, vec3 b, vec3 c) { return dot(a, cross(b, c)); }

// A unit vector, not below the grid's lowest ring: what is lower is taken at the ring.
vec3 above_ring(vec3 direction, uint across) {
    vec3 d = vec3(direction.x, direction.y, max(direction.z, 0.0));
    float size = length(d);
    // The squares of longer ones are not finite.
    if (!(size > 0.0 && size < 1e18)) return vec3(0.0, 0.0, 1.0);
    d = d / size;
    float ring = 1.0 - 1.0 / float(across);
    float lowest = 1.0 - ring * ring;
    if (d.z >= lowest) return d;
    float stretch = sqrt((1.0 - lowest * lowest) / (d.x * d.x + d.y * d.y));
    return vec3(d.x * stretch, d.y * stretch, lowest);
}

// Corners of a cell of the grid counter-clockwise from its lower left one.
uint sphere_corner(uvec2 cell, uint across, uint k) {
    uint right = (k == 1u || k == 2u) ? 1u : 0u;
    return (cell.y + (k >> 1)) * across + cell.x + right;
}

// `table`: first word of across * across directions.
SphereShares sphere_shares(uvec2 layer, uint table, uint across, vec3 direction) {
    vec3 d = above_ring(direction, across);
    vec2 grid = hemisphere_square(d) * float(across) - vec2(0.5, 0.5);
    float last = float(across - 2u);
    uvec2 cell = uvec2(uint(clamp(floor(grid.x), 0.0, last)), uint(clamp(floor(grid.y), 0.0, last)));
    vec3 corner[4];
    float edge[4];
    // Cells end at great circles between their corners, which is not quite where those of the square do.
    for (uint tries = 1u;; ++tries) {
        for (uint k = 0u; k < 4u; ++k) corner[k] = btf_table_direction(layer, table, sphere_corner(cell, across, k));
        for (uint k = 0u; k < 4u; ++k) edge[k] = triple_product(d, corner[k], corner[(k + 1u) & 3u]);
        bool lower = edge[0] < 0.0 && cell.y > 0u;
        bool upper = edge[2] < 0.0 && cell.y + 2u < across;
        bool right = edge[1] < 0.0 && cell.x + 2u < across;
        bool left = edge[3] < 0.0 && cell.x > 0u;
        if (tries == 4u || !(lower || upper || right || left)) break;
        if (lower || upper) cell.y = lower ? cell.y - 1u : cell.y + 1u;
        else cell.x = left ? cell.x - 1u : cell.x + 1u;
    }
    SphereShares shares;
    float sum = 0.0;
    for (uint k = 0u; k < 4u; ++k) {
        float whole = triple_product(corner[(k + 3u) & 3u], corner[k], corner[(k + 1u) & 3u]);
        float share = whole * max(edge[(k + 1u) & 3u], 0.0) * max(edge[(k + 2u) & 3u], 0.0);
        shares.cell[k] = sphere_corner(cell, across, k);
        shares.share[k] = share;
        sum += share;
    }
    for (uint k = 0u; k < 4u; ++k) {
        float first = k == 0u ? 1.0 : 0.0;
        shares.share[k] = sum > 0.0 ? shares.share[k] / sum : first;
    }
    return shares;
}

// `at`: 0..1 of the map's width and height, in the plane w = 0; `to_viewer`: along (u, v, w), metres; `mip` beyond the last is the last.
BtfPlace btf_place(Btf btf, vec2 at, vec3 to_viewer, uint mip) {
    SphereShares views = sphere_shares(btf.layer, uint(BTF_VIEW_TABLE), btf.views_across, to_viewer);
    uint side_log2 = btf.patch_log2 - min(mip, btf.patch_log2);
    uint side = 1u << side_log2;
    // Finer mips come before: (4 n - 4 m) / 3 texels.
    uint first = ((4u << (2u * btf.patch_log2)) - (4u << (2u * side_log2))) / 3u;
    float last = float(side - 1u);
    vec2 grid = vec2(clamp(at.x * float(side) - 0.5, 0.0, last), clamp(at.y * float(side) - 0.5, 0.0, last));
    uvec2 low = uvec2(uint(grid.x), uint(grid.y));
    vec2 part = vec2(grid.x - float(low.x), grid.y - float(low.y));
    BtfPlace place;
    for (uint k = 0u; k < 4u; ++k) {
        bool right = (k & 1u) != 0u;
        bool above = (k & 2u) != 0u;
        uint texel = first + min(low.y + (above ? 1u : 0u), side - 1u) * side + min(low.x + (right ? 1u : 0u), side - 1u);
        float share = (right ? part.x : 1.0 - part.x) * (above ? part.y : 1.0 - part.y);
        for (uint v = 0u; v < 4u; ++v) {
            place.record[4u * k + v] = views.cell[v] * btf.texels_a_view + texel;
            place.share[4u * k + v] = share * views.share[v];
        }
    }
    return place;
}

// Bytes of four groups of a record's words, interpolated.
BtfSixteen btf_sixteen(Btf btf, BtfPlace place, uint group) {
    BtfSixteen sum;
    for (uint i = 0u; i < 4u; ++i) sum.four[i] = vec4(0.0, 0.0, 0.0, 0.0);
    for (uint r = 0u; r < 16u; ++r) {
        if (place.share[r] == 0.0) continue;
        uint word = btf.records + place.record[r] * uint(BTF_RECORD_WORDS);
        uvec4 words = layer_words4(btf.layer, (word >> 2) + group);
        for (uint i = 0u; i < 4u; ++i) sum.four[i] = sum.four[i] + place.share[r] * unpackUnorm4x8(words[i]);
    }
    return sum;
}

// b of directions 16 * group .. 16 * group + 15; group < 4.
BtfSixteen btf_values(Btf btf, BtfPlace place, uint group) { return btf_sixteen(btf, place, group); }

// Shares of the palette slots in the light; they add up to 1, or all are 0 where nothing is hit.
BtfSixteen btf_slot_shares(Btf btf, BtfPlace place) {
    BtfSixteen shares = btf_sixteen(btf, place, uint(BTF_RECORD_SLOTS) >> 2);
    float sum = 0.0;
    for (uint i = 0u; i < 4u; ++i) sum += dot(shares.four[i], vec4(1.0, 1.0, 1.0, 1.0));
    for (uint i = 0u; i < 4u; ++i) shares.four[i] = sum > 0.0 ? shares.four[i] / sum : vec4(0.0, 0.0, 0.0, 0.0);
    return shares;
}

// Share of rays that hit something: the rest saw through open texels.
float btf_coverage(Btf btf, BtfPlace place) {
    if (btf.coverage == 0u) return 1.0;
    float sum = 0.0;
    for (uint r = 0u; r < 16u; ++r) {
        uint word = layer_word(btf.layer, btf.coverage + (place.record[r] >> 2));
        sum += place.share[r] * float(word >> (8u * (place.record[r] & 3u)) & 255u);
    }
    return sum * (1.0 / 255.0);
}

float btf_value(Btf btf, BtfPlace place, uint direction) {
    float sum = 0.0;
    for (uint r = 0u; r < 16u; ++r) {
        uint word = btf.records + place.record[r] * uint(BTF_RECORD_WORDS) + (direction >> 2);
        sum += place.share[r] * float(layer_word(btf.layer, word) >> (8u * (direction & 3u)) & 255u);
    }
    return sum * (1.0 / 255.0);
}

// Mean cosine of a local direction to the wall's normal, as irradiance has it.
float btf_mean_cosine(Btf btf, uint direction) {
    return float(layer_word(btf.layer, uint(BTF_DIRECTION_TABLE + 3) + uint(BTF_DIRECTION_WORDS) * direction) & 0xffffu) * (1.0 / 65536.0);
}

// How much of a uniform sky's light is turned to the viewer, of what a plain wall without relief turns.
float btf_openness(Btf btf, BtfPlace place) {
    float shown = 0.0;
    float plain = 0.0;
    for (uint group = 0u; group < 4u; ++group) {
        BtfSixteen values = btf_values(btf, place, group);
        for (uint i = 0u; i < 16u; ++i) {
            uint word = layer_word(btf.layer, uint(BTF_DIRECTION_TABLE + 3) + uint(BTF_DIRECTION_WORDS) * (16u * group + i));
            float share = float(word >> 16);
            shown += share * values.four[i >> 2][i & 3u];
            plain += share * float(word & 0xffffu) * (1.0 / 65536.0);
        }
    }
    return shown / plain;
}

// What takes the place of the cosine for the sun: a plain wall's is that to its normal. The light directions around the sun are interpolated as views
// are. `to_sun`: along (u, v, w), unit.
float btf_sun_cosine(Btf btf, BtfPlace place, vec3 to_sun) {
    if (to_sun.z <= 0.0) return 0.0;
    SphereShares lights = sphere_shares(btf.layer, uint(BTF_DIRECTION_TABLE), uint(BTF_DIRECTIONS_ACROSS), to_sun);
    float shown = 0.0;
    float plain = 0.0;
    for (uint k = 0u; k < 4u; ++k) {
        shown += lights.share[k] * btf_value(btf, place, lights.cell[k]);
        plain += lights.share[k] * btf_mean_cosine(btf, lights.cell[k]);
    }
    return to_sun.z * shown / plain;
}

#endif
