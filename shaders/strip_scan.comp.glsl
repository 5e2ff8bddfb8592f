#version 460
// The scans of a batch's strip streams that must be done before any triangle: explicit references U from the Simple-9 words, and for each word of INC
// the set bits before it. In one pass with look-back; or in passes, of which the first two also do what comes before each block of steps.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#ifdef SCAN_SUBGROUPS
#extension GL_KHR_shader_subgroup_shuffle_relative : require
#endif

#include "shaders/strip_stream.glsl"

// First block of a kind in the state.
uint first_block(uint kind) {
    uint first = 0u;
    for (uint k = 0u; k < kind; ++k) first += constants.blocks[k];
    return first;
}

void find_kind(uint block) {
    strip_kind = block < constants.blocks[0] ? STRIP_KIND_CODES : block < first_block(STRIP_KIND_STEPS) ? STRIP_KIND_INCREMENTS : STRIP_KIND_STEPS;
}

uvec2 scan_block_total(uint block) {
    uint mesh, at, word;
    uvec2 value = strip_load(block - first_block(strip_kind), mesh, at, word);
    uvec2 before, total;
    scan_workgroup(value, before, total);
    return total;
}

// `before`: of the words of the mesh before.
void write_explicit(StripRecord mesh, uint word, uvec2 before) {
    StripWords temporary = StripWords(layer_reference(constants.temporary));
    uint selector = simple9_selector(word);
    uint width = kSimple9Widths[selector];
    uint prediction = mesh.mode >> STRIP_PREDICTION_BIT;
    uint begin = min(before.x, mesh.explicit_references);
    uint end = min(begin + kSimple9Counts[selector], mesh.explicit_references);
    uint reference = before.y;
    uint shift = SIMPLE9_SELECTOR_BITS;
    for (uint k = begin; k < end; ++k, shift += width) {
        reference += strip_difference(word, shift, width, prediction);
        temporary.word[mesh.explicit_at + k] = reference;
    }
}

void main() {
    ScanSums sums = ScanSums(layer_reference(constants.state));
    ScanState state = ScanState(layer_reference(constants.state));
    if (kPhase == SCAN_PHASE_SUMS) {
        strip_kind = gl_WorkGroupID.x;
        scan_sums(sums, first_block(strip_kind), constants.blocks[strip_kind]);
        return;
    }
    uint block = kPhase == SCAN_PHASE_LOOK_BACK ? scan_ticket(state) : gl_WorkGroupID.x;
    find_kind(block);
    uint mesh, at, word;
    uvec2 value = strip_load(block - first_block(strip_kind), mesh, at, word);
    uvec2 before, total;
    scan_workgroup(value, before, total);
    if (kPhase == SCAN_PHASE_REDUCE) {
        if (scan_lane() == 0u) sums.block[block] = total;
        return;
    }
    uvec2 blocks_before = kPhase == SCAN_PHASE_LOOK_BACK ? scan_look_back(state, first_block(strip_kind), block, total) : sums.block[block];
    if (scan_lane() + SCAN_LANES * (block - first_block(strip_kind)) >= constants.words[strip_kind]) return;
    before = at == 0u ? uvec2(0u) : scan_combine(blocks_before, before) & uvec2(~STRIP_HEAD, ~0u);
    StripRecord record = StripRecords(layer_reference(constants.records)).record[mesh];
    if (strip_kind == STRIP_KIND_CODES) write_explicit(record, word, before);
    else StripWords(layer_reference(constants.temporary)).word[record.ranks_at + at] = before.x;
}
