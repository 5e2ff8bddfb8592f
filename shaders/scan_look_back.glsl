// What comes before a block, in the same pass that scans it: decoupled look-back (Merrill and Garland 2016). A block publishes its total, then walks back
// over its predecessors, adding up totals until it meets one that knows its prefix.
//
// Nothing is taken for granted about when other workgroups run: where a predecessor says nothing for kPatience looks, its total is made here from the
// elements themselves, so every workgroup ends whether or not the others go on. Publishing is by atomicMax of words that say themselves what they are
// (scan_layout.h): no order between words is needed, and a total that two workgroups publish is the same.
#ifndef CITYSTREAM_SCAN_LOOK_BACK_GLSL
#define CITYSTREAM_SCAN_LOOK_BACK_GLSL

#include "shaders/scan_workgroup.glsl"

layout(constant_id = SCAN_PATIENCE_CONSTANT) const uint kPatience = 256u;
layout(constant_id = SCAN_SILENT_CONSTANT) const uint kSilent = 0u;

layout(buffer_reference, std430, buffer_reference_align = 4) coherent buffer ScanState { uint word[]; };

// Of one block's elements, by all lanes; the includer defines it.
uvec2 scan_block_total(uint block);

shared uint scan_shared_ticket;
shared uvec2 scan_window[SCAN_WINDOW];
shared uint scan_window_flag[SCAN_WINDOW];

// The next block that no workgroup has taken: those before it are taken by workgroups that run or have ended.
uint scan_ticket(ScanState state) {
    if (scan_lane() == 0u) scan_shared_ticket = atomicAdd(state.word[0], 1u);
    barrier();
    uint ticket = scan_shared_ticket;
    barrier();
    return ticket;
}

void scan_publish(ScanState state, uint block, uvec2 value, uint flag) {
    uint lane = scan_lane();
    if (lane >= SCAN_STATE_WORDS) return;
    uint word = lane < 2u ? value.x : value.y;
    uint half_word = (lane & 1u) == 0u ? word & 0xffffu : word >> 16;
    atomicMax(state.word[SCAN_TICKET_WORDS + SCAN_STATE_WORDS * block + lane], flag << SCAN_FLAG_BIT | half_word);
}

// SCAN_FLAG_NONE where the four words are not all there yet.
uint scan_look(ScanState state, uint block, out uvec2 value) {
    uint at = SCAN_TICKET_WORDS + SCAN_STATE_WORDS * block;
    uvec4 words = uvec4(atomicOr(state.word[at], 0u), atomicOr(state.word[at + 1u], 0u), atomicOr(state.word[at + 2u], 0u),
                        atomicOr(state.word[at + 3u], 0u));
    value = uvec2(words.x & 0xffffu | words.y << 16, words.z & 0xffffu | words.w << 16);
    uvec4 flags = words >> SCAN_FLAG_BIT;
    return all(equal(flags, flags.xxxx)) ? flags.x : SCAN_FLAG_NONE;
}

// Of all blocks first .. block - 1, for a block whose own total is `total`. All lanes call it.
uvec2 scan_look_back(ScanState state, uint first, uint block, uvec2 total) {
    bool silent = kSilent != 0u && block % kSilent == kSilent - 1u;
    if (!silent) scan_publish(state, block, total, block == first ? SCAN_FLAG_PREFIX : SCAN_FLAG_TOTAL);
    uvec2 before = uvec2(0u);
    uint end = block;  // first .. end - 1 are still to be added
    uint looks = 0u;
    bool found = false;
    while (end > first && !found) {
        uint lane = scan_lane();
        uint window = min(uint(SCAN_WINDOW), end - first);
        if (lane < window) scan_window_flag[lane] = scan_look(state, end - 1u - lane, scan_window[lane]);
        barrier();
        uint walked = 0u;
        while (walked < window && !found && scan_window_flag[walked] != SCAN_FLAG_NONE) {
            before = scan_combine(scan_window[walked], before);
            found = scan_window_flag[walked] == SCAN_FLAG_PREFIX;
            ++walked;
        }
        barrier();
        end -= walked;
        looks = walked == 0u ? looks + 1u : 0u;
        if (looks > kPatience) {
            --end;
            uvec2 missing = scan_block_total(end);
            scan_publish(state, end, missing, SCAN_FLAG_TOTAL);
            before = scan_combine(missing, before);
            looks = 0u;
        }
    }
    if (!silent && block != first) scan_publish(state, block, scan_combine(before, total), SCAN_FLAG_PREFIX);
    return before;
}

#endif
