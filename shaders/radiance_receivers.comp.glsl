#version 460
// Third light pass: the irradiance of each receiver, the part of its rows' sum along its normal, a thread a receiver. Parts have 47 bits and are rounded to
// halves as codec/radiance/irradiance.h does.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_normal.glsl"

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

uint half_along(WholeNormal normal, LightVector sum, int channel) {
    uint high, low;
    part_along(normal, ivec3(int(sum.x[channel]), int(sum.y[channel]), int(sum.z[channel])), high, low);
    return irradiance_half(high, low);
}

void main() {
    uint group = group_number();
    if (group >= constants.groups) return;
    RadianceJob job = job_of(group, uint(RADIANCE_PASS_RECEIVERS));
    uint receiver = item_of(job, group, uint(RADIANCE_PASS_RECEIVERS));
    if (receiver >= job.receivers) return;
    uvec2 layer = layer_reference(job.layer);
    uint row_bits = bits_at(job.bits, 24u);
    LightVector sum = no_light();
    for (uint d = 0u; d < job.locals; ++d) {
        uint row = min(read_bits(layer, job.row_fields, (receiver * job.locals + d) * row_bits, row_bits), job.rows - 1u);
        add_scaled(sum, 1u, vector_at(constants.sums, job.first_sum + job.clusters + row));
    }
    WholeNormal normal = receiver_normal(layer, job, receiver);
    uint at = job.irradiance_word + uint(IRRADIANCE_WORDS) * receiver;
    write_word(layer, at, half_along(normal, sum, 0) | half_along(normal, sum, 1) << 16);
    write_word(layer, at + 1u, half_along(normal, sum, 2) | IRRADIANCE_LIT << 16);
}
