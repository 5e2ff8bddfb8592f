// Words of precision buffers, and positions by the rule that closes cracks. Twin of codec/mesh/adaptive_precision.h, precision.h and shown_position of
// binned_buffer.h: same integers.
#ifndef CITYSTREAM_PRECISION_FETCH_GLSL
#define CITYSTREAM_PRECISION_FETCH_GLSL

#include "codec/mesh/precision_layout.h"
#include "shaders/bits.glsl"

// Where a vertex lies in a buffer.
struct PrecisionPlace {
    uint base;   // word at which the payload begins
    uint bit;    // of the vertex, from there
    uint level;  // bits it has, of full_bits
    uint least_level;
    uint full_bits;
    uint leading;  // as in the header
};

struct PrecisionVertex {
    uvec3 words;  // bits that are not there are 0
    uint level;
    uint least_level;
    uint full_bits;
};

uint precision_field_bits(uint leading, uint component, uint level) { return level - min(level, leading >> 8u * component & 255u); }

uint precision_record_bits(uint leading, uint components, uint level) {
    uint bits = precision_field_bits(leading, 0u, level);
    if (components > 1u) bits += precision_field_bits(leading, 1u, level);
    if (components > 2u) bits += precision_field_bits(leading, 2u, level);
    if (components > 3u) bits += precision_field_bits(leading, 3u, level);
    return bits;
}

uint precision_bin_entry(uvec2 words, uint bin) {
    return layer_word(words, PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bin);
}

// The last bin that does not begin behind the vertex.
uint precision_bin_of(uvec2 words, uint bins, uint vertex) {
    uint bin = 0u;
    for (uint step = PRECISION_MOST_BINS / 2u; step > 0u; step >>= 1) {
        uint next = bin + step;
        if (next < bins && (precision_bin_entry(words, next) & ((1u << PRECISION_BIN_LEVEL_SHIFT) - 1u)) <= vertex) bin = next;
    }
    return bin;
}

PrecisionPlace precision_place(uvec2 words, uint vertex) {
    uint shape = layer_word(words, PRECISION_WORD_SHAPE);
    uint bins = shape & 255u;
    uint bin = bins > 1u ? precision_bin_of(words, bins, vertex) : 0u;
    uint entry = precision_bin_entry(words, bin);
    uint least = entry >> PRECISION_BIN_LEVEL_SHIFT;
    uint level = max(shape >> 24, least);
    uint leading = layer_word(words, PRECISION_WORD_LEADING);
    uint within = vertex - (entry & ((1u << PRECISION_BIN_LEVEL_SHIFT) - 1u));
    uint first = layer_word(words, PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bin + 1u);
    return PrecisionPlace(PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bins,
                          first + within * precision_record_bits(leading, shape >> 8 & 255u, level), level, least, shape >> 16 & 255u, leading);
}

uint precision_low_bits(uint bits) { return (1u << bits) - 1u; }

// Three fields of 0..31 bits each, one after the other, in at most four loads. Nothing behind the word that the last of them ends in is touched.
uvec3 precision_fields(uvec2 words, uint base, uint bit, uvec3 bits) {
    uint all = bits.x + bits.y + bits.z;
    if (all == 0u) return uvec3(0u);
    uint first = base + (bit >> 5);
    uint last = base + (bit + all - 1u >> 5);
    uint shift = bit & 31u;
    uint second = layer_word(words, min(first + 1u, last));
    uint third = layer_word(words, min(first + 2u, last));
    uint low = read_across(layer_word(words, first), second, shift);
    uint middle = read_across(second, third, shift);
    uint high = read_across(third, layer_word(words, last), shift);
    uint two = bits.x + bits.y;
    uint z = two < 32u ? read_across(low, middle, two) : read_across(middle, high, two - 32u);
    return uvec3(low, read_across(low, middle, bits.x), z) & uvec3(precision_low_bits(bits.x), precision_low_bits(bits.y), precision_low_bits(bits.z));
}

// Of a buffer of three components.
PrecisionVertex precision_fetch3(uvec2 words, uint vertex) {
    PrecisionPlace place = precision_place(words, vertex);
    uvec3 bits = uvec3(precision_field_bits(place.leading, 0u, place.level), precision_field_bits(place.leading, 1u, place.level),
                       precision_field_bits(place.leading, 2u, place.level));
    uvec3 known = precision_fields(words, place.base, place.bit, bits);
    return PrecisionVertex(known << place.full_bits - place.level, place.level, place.least_level, place.full_bits);
}

// A texture coordinate in 2^-16 repeats, of a buffer of two components. Twin of TexcoordWords::coordinate.
ivec2 precision_texcoord(uvec2 words, uint vertex, ivec2 base, uvec2 shift) {
    PrecisionPlace place = precision_place(words, vertex);
    uvec2 bits = uvec2(precision_field_bits(place.leading, 0u, place.level), precision_field_bits(place.leading, 1u, place.level));
    uvec2 known = precision_fields(words, place.base, place.bit, uvec3(bits, 0u)).xy;
    uint missing = place.full_bits - place.level;
    uvec2 spanned = uvec2(place.full_bits) - uvec2(place.leading & 255u, place.leading >> 8 & 255u);
    uvec2 open = min(uvec2(missing), spanned) + shift;
    return base + ivec2((known << missing << shift) + (uvec2(1u) << open >> 1));
}

// Lower bound of a distance, exact in integers.
uint precision_distance(uvec3 gaps) {
    uvec3 gap = gaps >> PRECISION_GAP_SHIFT;
    uint a = max(gap.x, max(gap.y, gap.z));
    uint c = min(gap.x, min(gap.y, gap.z));
    uint b = gap.x + gap.y + gap.z - a - c;
    uint bound = max(PRECISION_WEIGHT_AXIS * a, PRECISION_WEIGHT_EDGE * (a + b));
    bound = max(bound, PRECISION_WEIGHT_CORNER * (a + b + c));
    bound = max(bound, PRECISION_WEIGHT_NEAR_AXIS_1 * a + PRECISION_WEIGHT_NEAR_AXIS_2 * b);
    return max(bound, PRECISION_WEIGHT_NEAR_CORNER_1 * a + PRECISION_WEIGHT_NEAR_CORNER_2 * (b + c));
}

// Bits that a vertex drops, seen from the camera: by the near corner of the cell that its highest bits name.
uint precision_dropped(ivec3 from_camera, uvec3 words, uint common_dropped, uint distance_per_unit) {
    uint inside = (1u << common_dropped) - 1u;
    ivec3 low = from_camera + ivec3(words & ~inside);
    ivec3 high = from_camera + ivec3(words | inside);
    ivec3 gaps = ivec3(low.x > 0 ? low.x - 1 : max(-high.x, 0), low.y > 0 ? low.y - 1 : max(-high.y, 0), low.z > 0 ? low.z - 1 : max(-high.z, 0));
    uint distance = precision_distance(uvec3(gaps));
    if (distance < distance_per_unit) return 0u;
    // The highest bit of distance / distance_per_unit.
    uint bits = uint(findMSB(distance) - findMSB(distance_per_unit));
    return min(common_dropped, distance_per_unit << bits > distance ? bits - 1u : bits);
}

uint precision_reading_offset(uint reading, uint dropped) {
    if (reading == PRECISION_READ_MIDDLE) return (1u << dropped) >> 1;
    return reading == PRECISION_READ_THIRDS ? PRECISION_THIRDS_PATTERN & ((1u << dropped) - 1u) : 0u;
}

// The position in grid units from `origin` (of the buffer's grid), as it is shown.
ivec3 precision_shown(PrecisionVertex vertex, ivec3 origin, ivec3 from_camera, uint common_dropped, uint distance_per_unit, uint reading) {
    uint granted = min(precision_dropped(from_camera, vertex.words, common_dropped, distance_per_unit), vertex.full_bits - vertex.least_level);
    uint dropped = max(granted, vertex.full_bits - vertex.level);
    return origin + ivec3((vertex.words >> dropped << dropped) + precision_reading_offset(reading, dropped));
}

#endif
