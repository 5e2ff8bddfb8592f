#version 460
// The last pass of the strip decoder: scans the steps of a block of words, then writes the three corners of each of their triangles. References are looked
// up one by one from U and the ranks of INC, so there is no list of them in memory.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#ifdef SCAN_SUBGROUPS
#extension GL_KHR_shader_subgroup_shuffle_relative : require
#endif

#include "shaders/strip_stream.glsl"

// Of each word of the block: its steps, the step before, its mesh, where it is in it, and what the mesh's words before it come to.
shared uint word_steps[SCAN_LANES];
shared uint word_step_before[SCAN_LANES];
shared uint word_mesh[SCAN_LANES];
shared uint word_at[SCAN_LANES];
shared uvec2 word_before[SCAN_LANES];

uvec2 scan_block_total(uint block) {
    uint mesh, at, word;
    uvec2 value = strip_load(block, mesh, at, word);
    uvec2 before, total;
    scan_workgroup(value, before, total);
    return total;
}

uint strip_vertex(StripRecord mesh, uint reference) {
    StripWords temporary = StripWords(layer_reference(constants.temporary));
    uint j = min(reference, mesh.references - 1u);
    uint increments = layer_word(layer_reference(mesh.layer), mesh.part_at[STRIP_KIND_INCREMENTS] + (j >> 5));
    uint met = temporary.word[mesh.ranks_at + (j >> 5)] + bitCount(increments & (1u << (j & 31u)) - 1u);
    uint vertex = met;
    if ((increments >> (j & 31u) & 1u) == 0u) {
        vertex = mesh.explicit_references == 0u ? 0u : temporary.word[mesh.explicit_at + min(j - met, mesh.explicit_references - 1u)];
    }
    return min(vertex, mesh.vertices - 1u);
}

// `before`: what the mesh's words before that of the steps come to; `at`: where the triangle's corners go.
void write_triangle(StripRecord mesh, StripSteps steps, uvec2 before, uint place, uint at) {
    uint last = before.x + strip_taken(steps, place) - 1u;
    uint kept = strip_kept(steps, place);
    kept = max(kept != 0u ? kept + before.x : before.y, 4u) - 4u;
    uint step_code = steps.word >> place * steps.bits & (1u << steps.bits) - 1u;
    uint old = strip_vertex(mesh, step_code >= STRIP_STEP_RESTART ? last - 2u : kept);
    uint middle = strip_vertex(mesh, last - 1u);
    bool next = step_code == STRIP_STEP_NEXT;
    StripWords corners = StripWords(layer_reference(constants.corners));
    corners.word[at] = next ? middle : old;
    corners.word[at + 1u] = next ? old : middle;
    corners.word[at + 2u] = strip_vertex(mesh, last);
}

void main() {
    strip_kind = STRIP_KIND_STEPS;
    ScanState state = ScanState(layer_reference(constants.steps_state));
    uint block = kPhase == SCAN_PHASE_LOOK_BACK ? scan_ticket(state) : gl_WorkGroupID.x;
    uint lane = scan_lane();
    uint mesh, at, word;
    uvec2 value = strip_load(block, mesh, at, word);
    uvec2 before, total;
    scan_workgroup(value, before, total);
    uvec2 blocks_before;
    if (kPhase == SCAN_PHASE_LOOK_BACK) blocks_before = scan_look_back(state, 0u, block, total);
    else blocks_before = ScanSums(layer_reference(constants.state)).block[constants.blocks[0] + constants.blocks[1] + block];
    StripRecords records = StripRecords(layer_reference(constants.records));
    word_steps[lane] = word;
    word_step_before[lane] = strip_step_before(records.record[mesh], at, word);
    word_mesh[lane] = mesh;
    word_at[lane] = at;
    word_before[lane] = at == 0u ? uvec2(0u) : scan_combine(blocks_before, before) & uvec2(~STRIP_HEAD, ~0u);
    barrier();
    // Sixteen lanes a word, which write neighbouring triangles, then the next word: nearly always of the same mesh.
    uint words = min(uint(SCAN_LANES), constants.words[STRIP_KIND_STEPS] - block * SCAN_LANES);
    uint first = lane & ~15u;
    uint end = min(first + 16u, words);
    StripRecord record;
    for (uint w = first; w < end; ++w) {
        if (w == first || word_at[w] == 0u) record = records.record[word_mesh[w]];
        StripSteps steps = strip_steps(word_steps[w], word_step_before[w], word_at[w] == 0u, strip_mode(record));
        uint first_triangle = word_at[w] << strip_steps_log2(record);
        uint count = min(1u << strip_steps_log2(record), record.triangles - first_triangle);
        for (uint place = lane & 15u; place < count; place += 16u)
            write_triangle(record, steps, word_before[w], place, record.corners_at + 3u * (first_triangle + place));
    }
}
