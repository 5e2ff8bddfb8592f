// What the passes that the light passes are measured against have in common: a workgroup adds up the light that a receiver gets.
#ifndef CITYSTREAM_BENCH_LIGHT_PEER_GLSL
#define CITYSTREAM_BENCH_LIGHT_PEER_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "tests/bench/light_peers_layout.h"

layout(local_size_x = LIGHT_PEER_GROUP) in;

layout(buffer_reference, std430, buffer_reference_align = 4) buffer Words { uint word[]; };

layout(push_constant) uniform Constants { LightPeerConstants constants; };

shared uint group_sum[LIGHT_PEER_SUM_WORDS];

struct LightVector {
    uvec3 x, y, z;
};

uint word_at(uint address[2], uint i) { return Words(uvec2(address[0], address[1])).word[i]; }

uint receiver_number() { return gl_WorkGroupID.y * uint(LIGHT_PEER_ROW_GROUPS) + gl_WorkGroupID.x; }

void add_light(inout LightVector sum, uint factor, uint texel) {
    Words light = Words(uvec2(constants.light[0], constants.light[1]));
    uint at = uint(LIGHT_PEER_SUM_WORDS) * texel;
    sum.x += factor * uvec3(light.word[at], light.word[at + 1u], light.word[at + 2u]);
    sum.y += factor * uvec3(light.word[at + 3u], light.word[at + 4u], light.word[at + 5u]);
    sum.z += factor * uvec3(light.word[at + 6u], light.word[at + 7u], light.word[at + 8u]);
}

// The sums of all threads of the group, written as the receiver's. Whole numbers: in any order the same.
void write_group_sum(uint receiver, LightVector sum) {
    if (gl_LocalInvocationID.x < uint(LIGHT_PEER_SUM_WORDS)) group_sum[gl_LocalInvocationID.x] = 0u;
    barrier();
    for (uint c = 0u; c < 3u; ++c) {
        atomicAdd(group_sum[c], sum.x[c]);
        atomicAdd(group_sum[3u + c], sum.y[c]);
        atomicAdd(group_sum[6u + c], sum.z[c]);
    }
    barrier();
    if (gl_LocalInvocationID.x < uint(LIGHT_PEER_SUM_WORDS))
        Words(uvec2(constants.sums[0], constants.sums[1])).word[uint(LIGHT_PEER_SUM_WORDS) * receiver + gl_LocalInvocationID.x] =
            group_sum[gl_LocalInvocationID.x];
}

#endif
