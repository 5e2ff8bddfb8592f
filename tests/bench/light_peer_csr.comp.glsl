#version 460
// Light by the entries of a transfer matrix in compressed sparse rows: a thread a row of the receiver's; of a matrix with one row a receiver, all of the
// group's threads in turn.
#extension GL_GOOGLE_include_directive : require

#include "tests/bench/light_peer.glsl"

void add_entry(inout LightVector sum, uint i) {
    uint entry = word_at(constants.content, i);
    add_light(sum, entry >> LIGHT_PEER_QUARTERS_SHIFT, entry & (1u << LIGHT_PEER_QUARTERS_SHIFT) - 1u);
}

void main() {
    uint receiver = receiver_number();
    if (receiver >= constants.receivers) return;
    LightVector sum = LightVector(uvec3(0u), uvec3(0u), uvec3(0u));
    if (constants.rows_each == 1u) {
        uint end = word_at(constants.starts, receiver + 1u);
        for (uint i = word_at(constants.starts, receiver) + gl_LocalInvocationID.x; i < end; i += uint(LIGHT_PEER_GROUP)) add_entry(sum, i);
    } else {
        for (uint d = gl_LocalInvocationID.x; d < constants.rows_each; d += uint(LIGHT_PEER_GROUP)) {
            uint row = receiver * constants.rows_each + d;
            uint end = word_at(constants.starts, row + 1u);
            for (uint i = word_at(constants.starts, row); i < end; ++i) add_entry(sum, i);
        }
    }
    write_group_sum(receiver, sum);
}
