// Decodes mesh layers word by word. Twin of MeshLayerView in codec/mesh/mesh_layer.h and of codec/mesh/octahedral.h: same integers.
#ifndef CITYSTREAM_MESH_FETCH_GLSL
#define CITYSTREAM_MESH_FETCH_GLSL

#include "codec/mesh/mesh_layout.h"
#include "shaders/bits.glsl"
#include "shaders/octahedral.glsl"

uint mesh_index(uvec2 mesh, uint widths, uint corner) {
    uint bits = widths & 255u;
    return read_bits(mesh, layer_word(mesh, MESH_WORD_INDICES), corner * bits, bits);
}

// Word of the chart table's entry that the triangle uses.
uint mesh_chart_entry(uvec2 mesh, uint widths, uint triangle) {
    uint bits = widths >> 8 & 255u;
    uint chart = read_bits(mesh, layer_word(mesh, MESH_WORD_CHARTS), triangle * bits, bits);
    return layer_word(mesh, MESH_WORD_CHART_TABLE) + chart * MESH_CHART_WORDS;
}

// A vertex's three fields of `bits` (0..30) bits, one after the other. Up to 64 bits are read at once.
uvec3 mesh_planes(uvec2 mesh, uint base, uint vertex, uint bits) {
    uint all = 3u * bits;
    uint bit = vertex * all;
    if (all > 64u) {
        return uvec3(read_bits(mesh, base, bit, bits), read_bits(mesh, base, bit + bits, bits),
                     read_bits(mesh, base, bit + 2u * bits, bits));
    }
    if (bits == 0u) return uvec3(0u);
    uint first = base + (bit >> 5);
    uint last = base + (bit + all - 1u >> 5);
    uint shift = bit & 31u;
    uint next = layer_word(mesh, min(first + 1u, last));
    uint low = read_across(layer_word(mesh, first), next, shift);
    uint high = all > 32u ? read_across(next, layer_word(mesh, last), shift) : 0u;
    uint third = 2u * bits < 32u ? low >> 2u * bits | high << (32u - 2u * bits) : high >> (2u * bits - 32u);
    return uvec3(low, low >> bits | high << (32u - bits), third) & ((1u << bits) - 1u);
}

// Tile-relative grid units: the known high bits of all resident steps, less the halves that made the steps before the last round.
ivec3 mesh_position(uvec2 mesh, uint widths, uint steps, uint step_begin[DRAW_MESH_STEPS - 1], uint vertex) {
    uvec3 known = mesh_planes(mesh, layer_word(mesh, MESH_WORD_POSITIONS), vertex, widths >> 16 & 255u);
    uint dropped = widths >> 24;
    uint rounding = 0u;
    // A fixed number of rounds, each with its header read whether it is there or not (then it is the layer's own):
    // software drivers read a word once for all vertices where its place is a constant of the draw and no branch is open.
    for (uint s = 1u; s < DRAW_MESH_STEPS; ++s) {
        uint plane_widths = layer_word(mesh, step_begin[s - 1u] + MESH_PLANES_WORD_WIDTHS);
        if (s < steps) {
            uint bits = plane_widths & 255u;
            rounding += 1u << (dropped - 1u);
            known = known << bits | mesh_planes(mesh, step_begin[s - 1u] + MESH_PLANES_HEADER_WORDS, vertex, bits);
            dropped = plane_widths >> 8;
        }
    }
    uvec3 origin = uvec3(layer_word(mesh, MESH_WORD_ORIGIN_X), layer_word(mesh, MESH_WORD_ORIGIN_Y),
                         layer_word(mesh, MESH_WORD_ORIGIN_Z));
    return ivec3(origin + (known << dropped) - rounding);
}

uint mesh_packed_normal(uvec2 mesh, uint vertex) {
    return layer_word(mesh, layer_word(mesh, MESH_WORD_NORMALS) + (vertex >> 1)) >> (16u * (vertex & 1u)) & 0xffffu;
}

// 2^-16 repeats of the chart's image.
ivec2 mesh_texcoord(uvec2 mesh, uint chart_entry, uint vertex) {
    uint q = layer_word(mesh, layer_word(mesh, MESH_WORD_TEXCOORDS) + vertex);
    uint shifts = layer_word(mesh, chart_entry + MESH_CHART_SHIFTS);
    return ivec2(layer_word(mesh, chart_entry + MESH_CHART_BASE_U) + ((q & 0xffffu) << (shifts & 255u)),
                 layer_word(mesh, chart_entry + MESH_CHART_BASE_V) + ((q >> 16) << (shifts >> 8)));
}

// The same in repeats. Whole repeats along an axis that repeats are left out, the same for all corners of the chart in this mesh: floats keep
// their bits for the fraction.
vec2 mesh_place(uvec2 mesh, uint chart_entry, uint vertex, bvec2 axis_repeats) {
    ivec2 base = ivec2(layer_word(mesh, chart_entry + MESH_CHART_BASE_U), layer_word(mesh, chart_entry + MESH_CHART_BASE_V));
    ivec2 left_out = ivec2(axis_repeats.x ? base.x & ~0xffff : 0, axis_repeats.y ? base.y & ~0xffff : 0);
    return vec2(mesh_texcoord(mesh, chart_entry, vertex) - left_out) * (1.0 / 65536.0);
}

#endif
