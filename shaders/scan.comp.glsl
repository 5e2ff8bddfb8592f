#version 460
// Inclusive or exclusive scan of a stream of elements of 1..32 bits, sum or maximum, a function applied as they are loaded, in one pass with look-back or
// in three (totals of blocks, what comes before each, elements). Segments are scanned each on its own.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#ifdef SCAN_SUBGROUPS
#extension GL_KHR_shader_subgroup_shuffle_relative : require
#endif

#include "shaders/scan_look_back.glsl"

layout(constant_id = SCAN_OPERATION_CONSTANT) const uint kOperation = SCAN_OPERATION_SUM;
layout(constant_id = SCAN_INCLUSIVE_CONSTANT) const uint kInclusive = 0u;
layout(constant_id = SCAN_ELEMENT_BITS_CONSTANT) const uint kElementBits = 32u;
layout(constant_id = SCAN_TRANSFORM_CONSTANT) const uint kTransform = SCAN_TRANSFORM_NONE;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer ScanInput { uint word[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer ScanOutput { uint word[]; };
layout(push_constant) uniform Constants { ScanConstants constants; };

uvec2 reference(uint address[2]) { return uvec2(address[0], address[1]); }

// Pairs: the scanned word, and whether a segment begins in what it is of.
uvec2 scan_combine(uvec2 left, uvec2 right) {
    if (right.y != 0u) return right;
    return uvec2(kOperation == SCAN_OPERATION_SUM ? left.x + right.x : max(left.x, right.x), left.y);
}

uint load_element(uint element) {
    uint word_log2 = uint(findMSB(32u / kElementBits));
    uint word = ScanInput(reference(constants.elements)).word[element >> word_log2];
    uint shift = kElementBits * (element & (1u << word_log2) - 1u);
    uint value = word >> shift & ~0u >> (32u - kElementBits);
    if (kTransform == SCAN_TRANSFORM_UNZIGZAG) return value >> 1 ^ -(value & 1u);
    if (kTransform == SCAN_TRANSFORM_STRIP_LENGTH) return value >= 2u ? 3u : 1u;
    return value;
}

// The first segment that begins at `element` or behind it.
uint segment_from(uint element) {
    ScanInput firsts = ScanInput(reference(constants.segments));
    uint low = 0u, high = constants.segment_count;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (firsts.word[middle] < element) low = middle + 1u;
        else high = middle;
    }
    return low;
}

// Walks the lane's elements from `running`, writing where asked to.
uvec2 walk_elements(uint block, uvec2 running, bool write) {
    uint first = block * SCAN_BLOCK_ELEMENTS + scan_lane() * SCAN_ITEMS;
    uint end = min(first + SCAN_ITEMS, constants.count);
    if (first >= end) return running;
    uint segment = segment_from(first);
    uint next = segment < constants.segment_count ? ScanInput(reference(constants.segments)).word[segment] : ~0u;
    for (uint element = first; element < end; ++element) {
        bool head = element == next;
        while (element == next) {
            ++segment;
            next = segment < constants.segment_count ? ScanInput(reference(constants.segments)).word[segment] : ~0u;
        }
        uvec2 after = scan_combine(running, uvec2(load_element(element), head ? 1u : 0u));
        if (write) ScanOutput(reference(constants.output_words)).word[element] = kInclusive != 0u ? after.x : head ? 0u : running.x;
        running = after;
    }
    return running;
}

uvec2 scan_block_total(uint block) {
    uvec2 before, total;
    scan_workgroup(walk_elements(block, uvec2(0u), false), before, total);
    return total;
}

void main() {
    ScanSums sums = ScanSums(reference(constants.state));
    if (kPhase == SCAN_PHASE_SUMS) {
        scan_sums(sums, 0u, constants.blocks);
        return;
    }
    ScanState state = ScanState(reference(constants.state));
    uint block = kPhase == SCAN_PHASE_LOOK_BACK ? scan_ticket(state) : gl_WorkGroupID.x;
    uvec2 before, total;
    scan_workgroup(walk_elements(block, uvec2(0u), false), before, total);
    if (kPhase == SCAN_PHASE_REDUCE) {
        if (scan_lane() == 0u) sums.block[block] = total;
        return;
    }
    uvec2 blocks_before = kPhase == SCAN_PHASE_LOOK_BACK ? scan_look_back(state, 0u, block, total) : sums.block[block];
    walk_elements(block, scan_combine(blocks_before, before), true);
}
