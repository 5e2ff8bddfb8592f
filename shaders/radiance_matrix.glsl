// What the light passes have in common: the job of a workgroup, and the fields of a layer's matrix (codec/radiance/radiance_resident_layout.h).
// A thread has one cluster, row, receiver, or word of local light. All of it is integers: the same words on every device, and on the CPU (codec/radiance/irradiance.h).
#ifndef CITYSTREAM_RADIANCE_MATRIX_GLSL
#define CITYSTREAM_RADIANCE_MATRIX_GLSL

#include "client/render/radiance_passes_layout.h"
#include "codec/radiance/radiance_layer_layout.h"
#include "codec/radiance/radiance_resident_layout.h"
#include "shaders/bits.glsl"

layout(local_size_x = RADIANCE_PASS_GROUP) in;

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer Jobs { RadianceJob job[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) buffer Sums { uint word[]; };

layout(push_constant) uniform Constants { RadiancePassConstants constants; };

// The number of this workgroup among those of all layers.
uint group_number() { return gl_WorkGroupID.y * uint(RADIANCE_PASS_ROW_GROUPS) + gl_WorkGroupID.x; }

// The last job that does not begin behind the group: jobs without a group in the pass come before one that has the same first.
RadianceJob job_of(uint group, uint pass) {
    Jobs jobs = Jobs(uvec2(constants.jobs[0], constants.jobs[1]));
    uint low = 0u;
    uint high = constants.job_count;
    while (high - low > 1u) {
        uint middle = low + high >> 1;
        if (jobs.job[middle].first_group[pass] <= group) low = middle;
        else high = middle;
    }
    return jobs.job[low];
}

// What this thread does of its job.
uint item_of(RadianceJob job, uint group, uint pass) { return (group - job.first_group[pass]) * uint(RADIANCE_PASS_GROUP) + gl_LocalInvocationID.x; }

uint bits_at(uint bits, uint shift) { return bits >> shift & 255u; }

// Start i of count + 1.
uint start_of(uvec2 layer, uint base, uint i, uint count, uint bits) {
    uint groups = (count + RADIANCE_START_GROUP) / RADIANCE_START_GROUP;
    return layer_word(layer, base + i / RADIANCE_START_GROUP) + read_bits(layer, base + groups, i * bits, bits);
}

// Light as a vector (codec/radiance/source_light.h): of red, green and blue the parts along the world's axes, two's complement.
struct LightVector {
    uvec3 x;
    uvec3 y;
    uvec3 z;
};

LightVector no_light() { return LightVector(uvec3(0u), uvec3(0u), uvec3(0u)); }

LightVector vector_at(uint address[2], uint i) {
    Sums sums = Sums(uvec2(address[0], address[1]));
    uint at = uint(RADIANCE_SUM_WORDS) * i;
    return LightVector(uvec3(sums.word[at], sums.word[at + 1u], sums.word[at + 2u]), uvec3(sums.word[at + 3u], sums.word[at + 4u], sums.word[at + 5u]),
                       uvec3(sums.word[at + 6u], sums.word[at + 7u], sums.word[at + 8u]));
}

void set_sum(uint i, LightVector sum) {
    Sums sums = Sums(uvec2(constants.sums[0], constants.sums[1]));
    uint at = uint(RADIANCE_SUM_WORDS) * i;
    for (uint c = 0u; c < 3u; ++c) {
        sums.word[at + c] = sum.x[c];
        sums.word[at + 3u + c] = sum.y[c];
        sums.word[at + 6u + c] = sum.z[c];
    }
}

void add_scaled(inout LightVector sum, uint factor, LightVector more) {
    sum.x += factor * more.x;
    sum.y += factor * more.y;
    sum.z += factor * more.z;
}

// A word of a layer, wherever its slots are.
void write_word(uvec2 layer, uint index, uint value) {
    if ((layer.x & LAYER_REF_DIRECT) != 0u) {
        Sums(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).word[index] = value;
        return;
    }
    Sums(PageTable(layer).slot[index >> SLOT_WORDS_LOG2]).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)] = value;
}

#endif
