#version 460
// Twin of ReliefMaskView::shares: what a mask leaves free around points of the relief.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/relief_mask.glsl"
#include "shaders/twin_records.glsl"

// How free a direction is, 0..1.
float relief_free(ReliefShares shares, uint direction) {
    float sum = shares.open;
    for (uint k = 0u; k < 4u; ++k) {
        uint half_bits = direction < 32u ? shares.bits[k].x : shares.bits[k].y;
        sum += (half_bits >> (direction & 31u) & 1u) != 0u ? shares.share[k] : 0.0;
    }
    return sum;
}

void main() {
    uint point = gl_GlobalInvocationID.x;
    if (point >= constants.count) return;
    WordArray words = twin_input();
    uint from = point * TWIN_RELIEF_INPUT_WORDS;
    vec3 at = vec3(uintBitsToFloat(words.word[from]), uintBitsToFloat(words.word[from + 1u]), uintBitsToFloat(words.word[from + 2u]));
    uint normal = words.word[from + 4u];
    int axis = int(normal & 255u);
    float side = (normal & 256u) != 0u ? 1.0 : -1.0;
    ReliefMask mask = relief_mask(layer_reference(constants.layer));
    ReliefShares shares = relief_shares(mask, at, words.word[from + 3u], axis, side);
    TwinOutput target = twin_output();
    uint to = point * TWIN_RELIEF_WORDS;
    for (uint j = 0u; j < uint(RELIEF_DIRECTIONS); ++j) {
        target.word[to + j] = floatBitsToUint(relief_free(shares, j));
        target.word[to + uint(RELIEF_DIRECTIONS) + j] = floatBitsToUint(relief_weight(mask, relief_face(axis, side), j));
    }
}
