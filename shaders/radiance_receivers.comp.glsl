#version 460
// Third light pass: the irradiance of each receiver, the sum of its rows weighted by the cosines of their local directions, a thread a receiver. Sums have
// 47 bits and are rounded to halves as codec/radiance/irradiance.h does.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_matrix.glsl"

// Twin of irradiance_half. Channel by channel: the sum is high * 2^32 + low.
uint irradiance_half(uint high, uint low) {
    int leading = high != 0u ? 32 + findMSB(high) : findMSB(low);
    int least_normal = IRRADIANCE_SUM_BITS - 14;
    int least = max(leading, least_normal);
    int shift = least - 10;  // 23..36
    // Half of what is shifted out is added first.
    int half_bit = shift - 1;
    uint carry;
    low = uaddCarry(low, half_bit < 32 ? 1u << half_bit : 0u, carry);
    high += carry + (half_bit < 32 ? 0u : 1u << half_bit - 32);
    uint rounded = shift < 32 ? low >> shift | high << 32 - shift : high >> shift - 32;
    return (uint(least - least_normal) << 10) + rounded;
}

void write_word(uvec2 layer, uint index, uint value) {
    if ((layer.x & LAYER_REF_DIRECT) != 0u) {
        Sums(uvec2(layer.x ^ LAYER_REF_DIRECT, layer.y)).word[index] = value;
        return;
    }
    Sums(PageTable(layer).slot[index >> SLOT_WORDS_LOG2]).word[index & ((1u << SLOT_WORDS_LOG2) - 1u)] = value;
}

void main() {
    uint group = group_number();
    if (group >= constants.groups) return;
    RadianceJob job = job_of(group, uint(RADIANCE_PASS_RECEIVERS));
    uint receiver = item_of(job, group, uint(RADIANCE_PASS_RECEIVERS));
    if (receiver >= job.receivers) return;
    uvec2 layer = layer_reference(job.layer);
    uint row_bits = bits_at(job.bits, 24u);
    WordArray weights = WordArray(uvec2(constants.weights[0], constants.weights[1]));
    uvec3 high = uvec3(0u);
    uvec3 low = uvec3(0u);
    for (uint d = 0u; d < job.locals; ++d) {
        uint row = min(read_bits(layer, job.row_fields, (receiver * job.locals + d) * row_bits, row_bits), job.rows - 1u);
        uvec3 sum = sum_at(constants.sums, job.first_sum + job.clusters + row);
        uvec3 more_high, more_low, carry;
        umulExtended(sum, uvec3(weights.word[job.first_weight + d]), more_high, more_low);
        low = uaddCarry(low, more_low, carry);
        high += more_high + carry;
    }
    uint at = job.irradiance_word + uint(IRRADIANCE_WORDS) * receiver;
    write_word(layer, at, irradiance_half(high.x, low.x) | irradiance_half(high.y, low.y) << 16);
    write_word(layer, at + 1u, irradiance_half(high.z, low.z) | IRRADIANCE_LIT << 16);
}
