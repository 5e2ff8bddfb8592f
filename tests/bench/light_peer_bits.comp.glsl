#version 460
// Light by brute force from visibility bits: an addition for each sample that the receiver sees, a thread a word of them.
#extension GL_GOOGLE_include_directive : require

#include "tests/bench/light_peer.glsl"

// Two samples on each side of a texel, as codec/radiance/source_directions.h numbers them.
uint texel_of(uint sample_number) {
    uint side = 2u * constants.texels_across;
    uint column = sample_number % side, row = sample_number / side % side, face = sample_number / side / side;
    return (face * constants.texels_across + row / 2u) * constants.texels_across + column / 2u;
}

void main() {
    uint receiver = receiver_number();
    if (receiver >= constants.receivers) return;
    LightVector sum = LightVector(uvec3(0u), uvec3(0u), uvec3(0u));
    for (uint w = gl_LocalInvocationID.x; w < constants.words_each; w += uint(LIGHT_PEER_GROUP)) {
        uint bits = word_at(constants.content, receiver * constants.words_each + w);
        while (bits != 0u) {
            add_light(sum, 1u, texel_of(32u * w + uint(findLSB(bits))));
            bits &= bits - 1u;
        }
    }
    write_group_sum(receiver, sum);
}
