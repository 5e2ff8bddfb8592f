#version 460
// Precision buffers at another level, many at once, with the words before them in their layers: one thread a word of what comes out, which gathers the
// fields that it holds from the buffer as it is and the new planes. Without a temporary buffer. Twin of change_level in codec/mesh/adaptive_precision.h.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/precision_merge_layout.h"
#include "codec/mesh/precision_layout.h"
#include "shaders/bits.glsl"

layout(local_size_x = PRECISION_MERGE_GROUP) in;

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Jobs { PrecisionMergeJob job[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer Target { uint word[]; };

layout(push_constant) uniform Constants { PrecisionMergeConstants constants; };

Jobs jobs() { return Jobs(uvec2(constants.jobs[0], constants.jobs[1])); }

// The last job that does not begin behind the word.
uint job_of(uint word) {
    uint low = 0u;
    uint high = constants.job_count;
    while (high - low > 1u) {
        uint middle = low + high >> 1;
        if (jobs().job[middle].first_word <= word) low = middle;
        else high = middle;
    }
    return low;
}

void write_target(uvec2 target, uint index, uint value) {
    if ((target.x & LAYER_REF_DIRECT) != 0u) Target(uvec2(target.x ^ LAYER_REF_DIRECT, target.y)).word[index] = value;
    else Target(PageTable(target).slot[index >> SLOT_WORDS_LOG2]).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)] = value;
}

// What is the same for all words of a job.
struct Merge {
    uint job;
    uint words_before;  // of the layer, before the buffer
    uvec2 source;
    uvec2 planes;
    uint vertices, bins, components, from_level, to_level;
    uvec4 leading;  // zeros of each component
};

Merge merge_of(uint job) {
    uvec2 source = layer_reference(jobs().job[job].source);
    uint before = jobs().job[job].words_before;
    uint shape = layer_word(source, before + PRECISION_WORD_SHAPE);
    uint leading = layer_word(source, before + PRECISION_WORD_LEADING);
    return Merge(job, before, source, layer_reference(jobs().job[job].planes), layer_word(source, before + PRECISION_WORD_VERTICES), shape & 255u, shape >> 8 & 255u,
                 shape >> 24, jobs().job[job].to_level, uvec4(leading, leading >> 8, leading >> 16, leading >> 24) & 255u);
}

// A word of the buffer as it is.
uint source_word(Merge merge, uint word) { return layer_word(merge.source, merge.words_before + word); }

uint bin_entry(Merge merge, uint bin) { return source_word(merge, PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bin); }

// A bin of the target. Of each component: the bits that it has, and where they begin in a vertex of the source.
struct Bin {
    uint begin, end;  // vertices
    uint first_bit;
    uint from_level, level;
    uvec4 from_bits, bits, from_begin;
    uint record;        // bits
    uint source_first;  // bit of the source, from its first word
    uint source_record;
};

uvec4 field_bits(uvec4 leading, uint components, uint level) {
    uvec4 bits = uvec4(level) - min(uvec4(level), leading);
    return mix(uvec4(0u), bits, lessThan(uvec4(0u, 1u, 2u, 3u), uvec4(components)));
}

Bin bin_of(Merge merge, uint bin, uint first_bit) {
    uint entry = bin_entry(merge, bin);
    uint mask = (1u << PRECISION_BIN_LEVEL_SHIFT) - 1u;
    uint end = bin + 1u < merge.bins ? bin_entry(merge, bin + 1u) & mask : merge.vertices;
    uint least = entry >> PRECISION_BIN_LEVEL_SHIFT;
    uint from_level = max(merge.from_level, least);
    uint level = max(merge.to_level, least);
    uvec4 from = field_bits(merge.leading, merge.components, from_level);
    uvec4 to = field_bits(merge.leading, merge.components, level);
    uint source_first = source_word(merge, PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bin + 1u);
    return Bin(entry & mask, end, first_bit, from_level, level, from, to, uvec4(0u, from.x, from.x + from.y, from.x + from.y + from.z),
               to.x + to.y + to.z + to.w, source_first, from.x + from.y + from.z + from.w);
}

uint last_bit(Bin bin) { return bin.first_bit + (bin.end - bin.begin) * bin.record; }

uint plane_bit(Merge merge, uint plane, uint component, uint vertex) {
    uvec4 present = mix(uvec4(0u), uvec4(1u), lessThanEqual(merge.leading, uvec4(plane)));
    uint before = component == 0u ? 0u : component == 1u ? present.x : component == 2u ? present.x + present.y : present.x + present.y + present.z;
    uint bit = before * jobs().job[merge.job].plane_vertices[plane] + vertex;
    return layer_word(merge.planes, jobs().job[merge.job].plane_begin[plane] + (bit >> 5)) >> (bit & 31u) & 1u;
}

// A component as the target holds it.
uint field(Merge merge, Bin bin, uint vertex, uint component) {
    uint base = merge.words_before + PRECISION_WORD_BINS + PRECISION_BIN_WORDS * merge.bins;
    uint bit = bin.source_first + (vertex - bin.begin) * bin.source_record + bin.from_begin[component];
    uint value = read_bits(merge.source, base, bit, bin.from_bits[component]);
    if (bin.level < bin.from_level) return value >> bin.from_level - bin.level;
    for (uint plane = max(bin.from_level, merge.leading[component]); plane < bin.level; ++plane) {
        value = value << 1 | plane_bit(merge, plane, component, vertex);
    }
    return value;
}

uint header_word(Merge merge, uint word) {
    if (word == PRECISION_WORD_SHAPE) return source_word(merge, word) & 0xffffffu | merge.to_level << 24;
    bool is_first_bit = word >= PRECISION_WORD_BINS && (word - PRECISION_WORD_BINS) % PRECISION_BIN_WORDS == 1u;
    if (!is_first_bit) return source_word(merge, word);
    uint bit = 0u;
    for (uint b = 0u; b < (word - PRECISION_WORD_BINS) / PRECISION_BIN_WORDS; ++b) bit = last_bit(bin_of(merge, b, bit));
    return bit;
}

uint payload_word(Merge merge, uint word) {
    uint begin = 32u * word;
    uint b = 0u;
    Bin bin = bin_of(merge, 0u, 0u);
    while (b + 1u < merge.bins && last_bit(bin) <= begin) bin = bin_of(merge, ++b, last_bit(bin));
    uint result = 0u;
    uint filled = 0u;  // bits of this word
    uint vertex = bin.begin, component = 0u, skip = 0u;
    if (bin.record > 0u) {
        vertex += (begin - bin.first_bit) / bin.record;
        skip = (begin - bin.first_bit) % bin.record;
        while (component + 1u < merge.components && skip >= bin.bits[component]) {
            skip -= bin.bits[component];
            ++component;
        }
    }
    while (filled < 32u) {
        if (vertex >= bin.end || bin.record == 0u) {
            if (b + 1u >= merge.bins) break;
            bin = bin_of(merge, ++b, last_bit(bin));
            vertex = bin.begin;
            component = 0u;
            continue;
        }
        uint bits = bin.bits[component];
        if (bits > 0u) {
            result |= field(merge, bin, vertex, component) >> skip << filled;
            filled += bits - skip;
            skip = 0u;
        }
        if (++component == merge.components) {
            component = 0u;
            ++vertex;
        }
    }
    return result;
}

uint target_word(Merge merge, uint word) {
    if (word < merge.words_before) return layer_word(merge.source, word);
    uint within = word - merge.words_before;
    uint header = PRECISION_WORD_BINS + PRECISION_BIN_WORDS * merge.bins;
    return within < header ? header_word(merge, within) : payload_word(merge, within - header);
}

void main() {
    uint row = PRECISION_MERGE_ROW_GROUPS * PRECISION_MERGE_GROUP;
    uint word = gl_GlobalInvocationID.y * row + gl_GlobalInvocationID.x;
    if (word >= constants.words) return;
    uint job = job_of(word);
    Merge merge = merge_of(job);
    write_target(layer_reference(jobs().job[job].target), word - jobs().job[job].first_word,
                 target_word(merge, word - jobs().job[job].first_word));
}
