// What the quotient and tiled forms share (codec/facade/quotient_layout.h): fields in groups of four words, run breaks, block maxima, label
// numbers. Twin of codec/facade/quotient_sections.h.
#ifndef CITYSTREAM_FACADE_RUNS_GLSL
#define CITYSTREAM_FACADE_RUNS_GLSL

#include "codec/facade/quotient_layout.h"
#include "shaders/facade_ray.glsl"

uint low_bits(uint value, uint bits) { return bits == 32u ? value : value & ((1u << bits) - 1u); }

// Field of 1..32 bits at a bit of a group; `next` is the word behind the group, for fields that cross into it.
uint group_field(uvec4 group, uint next, uint bit, uint bits) {
    uint index = bit >> 5;
    uint shift = bit & 31u;
    uint value = group[index] >> shift;
    if (shift + bits > 32u) value |= (index == 3u ? next : group[index + 1u]) << (32u - shift);
    return low_bits(value, bits);
}

// Field of a section whose fields do not cross groups: one load.
uint section_field(uvec2 layer, uint first_group, uint index, uint bits) {
    if (bits == 0u) return 0u;
    uint in_group = 128u / bits;
    uint group = index / in_group;
    return group_field(layer_words4(layer, first_group + group), 0u, (index - group * in_group) * bits, bits);
}

// Field at any bit of a section: one load, two where it crosses groups.
uint dense_field(uvec2 layer, uint first_group, uint bit, uint bits) {
    if (bits == 0u) return 0u;
    uint group = first_group + (bit >> 7);
    uint next = 0u;
    if ((bit & 127u) + bits > 128u) next = layer_word(layer, 4u * group + 4u);
    return group_field(layer_words4(layer, group), next, bit & 127u, bits);
}

struct FacadeRun {
    uint index;
    uint begin;  // texels
    uint end;
};

uint run_row_breaks(FacadeMap map) { return uint(RUN_BREAKS_GROUP) + (map_width(map) + uint(RUN_GROUP_TEXELS) - 1u) / uint(RUN_GROUP_TEXELS); }
uint run_block_maxima(FacadeMap map) { return run_row_breaks(map) + (map_height(map) + uint(RUN_GROUP_TEXELS) - 1u) / uint(RUN_GROUP_TEXELS); }

// Bits of the word 32 * word of a mask that are below `count` (of all words).
uint bits_below(uint count, uint word) {
    uint first = 32u * word;
    if (count <= first) return 0u;
    return count - first >= 32u ? 0xffffffffu : (1u << (count - first)) - 1u;
}

// The run of texel `first` + `at`, from the group whose texels begin at `first`.
FacadeRun group_run(uvec4 group, uint first, uint at) {
    const uint kRankMask = (1u << uint(RUN_RANK_BITS)) - 1u;
    uvec3 breaks = uvec3(group.x, group.y, low_bits(group.z, uint(RUN_LAST_BITS)));
    uvec3 below = uvec3(breaks.x & bits_below(at + 1u, 0u), breaks.y & bits_below(at + 1u, 1u), breaks.z & bits_below(at + 1u, 2u));
    uvec3 above = breaks ^ below;
    FacadeRun run = FacadeRun((group.w & kRankMask) + uint(bitCount(below.x) + bitCount(below.y) + bitCount(below.z)) - 1u,
                              group.w >> uint(RUN_BEFORE_BIT) & kRankMask,
                              group.w >> uint(RUN_BEHIND_LOW_BIT) | group.z >> uint(RUN_BEHIND_HIGH_BIT) << uint(RUN_BEHIND_LOW_BITS));
    if (below.z != 0u) run.begin = first + 64u + uint(findMSB(below.z));
    else if (below.y != 0u) run.begin = first + 32u + uint(findMSB(below.y));
    else if (below.x != 0u) run.begin = first + uint(findMSB(below.x));
    if (above.x != 0u) run.end = first + uint(findLSB(above.x));
    else if (above.y != 0u) run.end = first + 32u + uint(findLSB(above.y));
    else if (above.z != 0u) run.end = first + 64u + uint(findLSB(above.z));
    return run;
}

FacadeRun facade_run(FacadeMap map, uint first_group, uint texel) {
    uint group = texel / uint(RUN_GROUP_TEXELS);
    uint first = group * uint(RUN_GROUP_TEXELS);
    return group_run(layer_words4(map.layer, first_group + group), first, texel - first);
}

// Greatest displacement in a block, from the byte that stands for it.
float block_greatest(FacadeMap map, uint level) {
    uint range = uint(map_depth_max(map) - map_depth_min(map));
    uint step = (range + uint(BLOCK_MAX_LEVELS) - 1u) / uint(BLOCK_MAX_LEVELS);
    return map_depth_min(map) + float(level * step);
}

// The label that a number stands for.
uint numbered_label(FacadeMap map, uint number, uint displacement_bits, uint step) {
    int depth = int(map_depth_min(map)) + int((number & ((1u << displacement_bits) - 1u)) * step);
    if (depth > int(map_depth_max(map))) depth = FACADE_OPEN_DISPLACEMENT;
    return (uint(depth) & 0xffffu) | number >> displacement_bits << 16;
}

#endif
