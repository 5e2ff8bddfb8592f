// Scan over a workgroup's lanes of pairs of words, with an associative operator (commutative or not) whose identity is (0, 0).
// The includer defines the operator. With SCAN_SUBGROUPS lanes hand their values on inside subgroups of any size, else through shared memory.
#ifndef CITYSTREAM_SCAN_WORKGROUP_GLSL
#define CITYSTREAM_SCAN_WORKGROUP_GLSL

#include "client/render/scan_layout.h"

layout(local_size_x = SCAN_LANES) in;
layout(constant_id = SCAN_PHASE_CONSTANT) const uint kPhase = SCAN_PHASE_LOOK_BACK;

// `left` comes before `right`.
uvec2 scan_combine(uvec2 left, uvec2 right);

shared uvec2 scan_values[SCAN_LANES];

#ifdef SCAN_SUBGROUPS

uint scan_lane() { return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID; }

// All lanes call it. `before`: of the lanes before this one; `total`: of all.
void scan_workgroup(uvec2 value, out uvec2 before, out uvec2 total) {
    for (uint reach = 1u; reach < gl_SubgroupSize; reach <<= 1) {
        uvec2 left = subgroupShuffleUp(value, reach);
        if (gl_SubgroupInvocationID >= reach) value = scan_combine(left, value);
    }
    uvec2 left = subgroupShuffleUp(value, 1u);
    before = gl_SubgroupInvocationID == 0u ? uvec2(0u) : left;
    if (gl_SubgroupInvocationID == gl_SubgroupSize - 1u) scan_values[gl_SubgroupID] = value;
    barrier();
    uvec2 subgroups = uvec2(0u);
    uint s = 0u;
    for (; s < gl_SubgroupID; ++s) subgroups = scan_combine(subgroups, scan_values[s]);
    before = scan_combine(subgroups, before);
    total = subgroups;
    for (; s < gl_NumSubgroups; ++s) total = scan_combine(total, scan_values[s]);
    barrier();
}

#else

uint scan_lane() { return gl_LocalInvocationIndex; }

void scan_workgroup(uvec2 value, out uvec2 before, out uvec2 total) {
    uint lane = scan_lane();
    for (uint reach = 1u; reach < SCAN_LANES; reach <<= 1) {
        scan_values[lane] = value;
        barrier();
        if (lane >= reach) value = scan_combine(scan_values[lane - reach], value);
        barrier();
    }
    scan_values[lane] = value;
    barrier();
    before = lane == 0u ? uvec2(0u) : scan_values[lane - 1u];
    total = scan_values[SCAN_LANES - 1];
    barrier();
}

#endif

layout(buffer_reference, std430, buffer_reference_align = 8) buffer ScanSums { uvec2 block[]; };

// One workgroup turns the totals of `count` blocks from `first` into what comes before each.
void scan_sums(ScanSums sums, uint first, uint count) {
    uvec2 carried = uvec2(0u);
    for (uint base = 0u; base < count; base += SCAN_LANES) {
        uint block = base + scan_lane();
        uvec2 before, total;
        scan_workgroup(block < count ? sums.block[first + block] : uvec2(0u), before, total);
        if (block < count) sums.block[first + block] = scan_combine(carried, before);
        carried = scan_combine(carried, total);
    }
}

#endif
