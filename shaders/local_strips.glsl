// The vertices of any triangle of local strips (codec/mesh/local_strips_layout.h), read where they lie: a group, the triangle's references in it, the vertex
// of one. Twin of local_triangle in codec/mesh/local_strips.h.
#ifndef CITYSTREAM_LOCAL_STRIPS_GLSL
#define CITYSTREAM_LOCAL_STRIPS_GLSL

#include "codec/mesh/local_strips_layout.h"
#include "shaders/bits.glsl"

// Bits 0 .. place of 64.
uvec2 local_up_to(uint place) {
    if (place < 32u) return uvec2(0xffffffffu >> (31u - place), 0u);
    return uvec2(0xffffffffu, 0xffffffffu >> (63u - place));
}

uint local_count(uvec2 bits) { return uint(bitCount(bits.x)) + uint(bitCount(bits.y)); }

uint local_highest(uvec2 bits) { return bits.y != 0u ? 32u + uint(findMSB(bits.y)) : uint(findMSB(bits.x)); }

struct LocalGroup {
    uint head, base, low;  // low with the number of frames, as in the words
    uvec2 steps, restarts;
    uint new_at, fields_at;  // words
};

// `triangles`: as the strips' header has them.
LocalGroup local_group(uvec2 layer, uint at, uint triangles, uint index) {
    uint groups = (triangles + uint(LOCAL_STRIPS_GROUP_TRIANGLES) - 1u) >> LOCAL_STRIPS_GROUP_SHIFT;
    uint blocks = (groups + uint(LOCAL_STRIPS_BLOCK_GROUPS) - 1u) >> LOCAL_STRIPS_BLOCK_SHIFT;
    uint blocks_at = at + uint(LOCAL_STRIPS_HEADER_WORDS);
    uint block_at = blocks_at + (index >> LOCAL_STRIPS_BLOCK_SHIFT) * uint(LOCAL_STRIPS_BLOCK_WORDS);
    uint head_at = blocks_at + blocks * uint(LOCAL_STRIPS_BLOCK_WORDS) + index * uint(LOCAL_STRIPS_GROUP_WORDS);
    LocalGroup group;
    group.head = layer_word(layer, head_at);
    group.low = layer_word(layer, head_at + 1u);
    group.base = layer_word(layer, block_at + uint(LOCAL_STRIPS_BLOCK_BASE)) + (group.head & LOCAL_STRIPS_SINCE_MASK);
    uint payload = at + layer_word(layer, block_at + uint(LOCAL_STRIPS_BLOCK_PAYLOAD)) + (group.head >> LOCAL_STRIPS_PAYLOAD_BIT & LOCAL_STRIPS_SINCE_MASK);
    bool has_restarts = group.head >> LOCAL_STRIPS_RESTARTS_BIT != 0u;
    group.steps = uvec2(layer_word(layer, payload), layer_word(layer, payload + 1u));
    group.restarts = uvec2(1u, 0u);
    if (has_restarts) group.restarts = uvec2(layer_word(layer, payload + 2u) | 1u, layer_word(layer, payload + 3u));
    group.new_at = payload + (has_restarts ? 4u : 2u);
    uint last = min(triangles - (index << LOCAL_STRIPS_GROUP_SHIFT), uint(LOCAL_STRIPS_GROUP_TRIANGLES)) - 1u;
    uint references = last + 1u + 2u * local_count(group.restarts & local_up_to(last));
    group.fields_at = group.new_at + (references + 31u) / 32u;
    return group;
}

// The vertex of reference j of a group.
uint local_vertex(uvec2 layer, LocalGroup group, uint j) {
    uint word = layer_word(layer, group.new_at + j / 32u);
    uint before = uint(bitCount(word & ((1u << (j & 31u)) - 1u)));
    for (uint i = 0u; i < j / 32u; ++i) before += uint(bitCount(layer_word(layer, group.new_at + i)));
    if ((word >> (j & 31u) & 1u) != 0u) return group.base + before;
    uint k = j - before;
    uint width = group.head >> LOCAL_STRIPS_WIDTH_BIT & LOCAL_STRIPS_WIDTH_MASK;
    uint field = read_bits(layer, group.fields_at, k * width, width);
    bool two_frames = (group.low >> LOCAL_STRIPS_FRAMES_BIT & 1u) != 0u;
    if (two_frames && field >> (width - 1u) != 0u) return group.base + before - 1u - (field ^ 1u << (width - 1u));
    uint slope = group.head >> LOCAL_STRIPS_SLOPE_BIT & LOCAL_STRIPS_SLOPE_MASK;
    uint line = slope == LOCAL_STRIPS_SLOPE_DOWN ? group.low - k : group.low + slope * k;
    return (line + field) & LOCAL_STRIPS_VERTEX_MASK;
}

// The references of triangle t of a group.
uvec3 local_references(LocalGroup group, uint t) {
    uvec2 until = local_up_to(t);
    uint last = t + 2u * local_count(group.restarts & until);
    uint restart = local_highest(group.restarts & until);
    if (restart == t) return uvec3(last - 2u, last - 1u, last);
    // The strip turned where a step differs from the one before, or at its second triangle.
    uvec2 before = uvec2(group.steps.x << 1u, group.steps.y << 1u | group.steps.x >> 31u);
    uvec2 turns = (group.steps ^ before) & ~local_up_to(restart + 1u) & until;
    uint turn = (turns.x | turns.y) != 0u ? local_highest(turns) : restart + 1u;
    uvec2 own = until & ~local_up_to(t - 1u);
    bool is_next = ((group.steps.x & own.x) | (group.steps.y & own.y)) != 0u;
    uint kept = last - (t - turn) - (turn == restart + 1u && !is_next ? 3u : 2u);
    return is_next ? uvec3(last - 1u, kept, last) : uvec3(kept, last - 1u, last);
}

// Triangle `index` of the local strips that begin at word `at` of a layer.
uvec3 local_triangle(uvec2 layer, uint at, uint index) {
    LocalGroup group = local_group(layer, at, layer_word(layer, at + uint(LOCAL_STRIPS_WORD_TRIANGLES)), index >> LOCAL_STRIPS_GROUP_SHIFT);
    uvec3 references = local_references(group, index & uint(LOCAL_STRIPS_GROUP_TRIANGLES - 1));
    return uvec3(local_vertex(layer, group, references.x), local_vertex(layer, group, references.y), local_vertex(layer, group, references.z));
}

#endif
