#version 460
// Fourth light pass: what each local direction adds to the irradiance of a receiver on a wall, a thread a direction. Twin of codec/radiance/local_light.h.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "codec/radiance/local_light_layout.h"
#include "shaders/radiance_normal.glsl"

uint rounded(uint value, uint shift) { return shift == 0u ? value : value + (1u << (shift - 1u)) >> shift; }

// Channels below 2^31.
uint local_light_word(uvec3 value) {
    uint greatest = max(value.x, max(value.y, value.z));
    uint exponent = uint(max(findMSB(greatest) + 1 - LOCAL_LIGHT_BITS, 0));
    if (rounded(greatest, exponent) >= 1u << LOCAL_LIGHT_BITS) ++exponent;
    return rounded(value.x, exponent) | rounded(value.y, exponent) << LOCAL_LIGHT_BITS | rounded(value.z, exponent) << 2 * LOCAL_LIGHT_BITS |
           exponent << 3 * LOCAL_LIGHT_BITS;
}

// In 2^-LOCAL_LIGHT_UNIT_BITS of the unit of irradiance, below 2^31: what a row's vector is along the normal, where it is in front of the surface.
uint direction_irradiance(WholeNormal normal, LightVector row, int channel) {
    uint high, low;
    part_along(normal, ivec3(int(row.x[channel]), int(row.y[channel]), int(row.z[channel])), high, low);
    const int shift = IRRADIANCE_SUM_BITS - LOCAL_LIGHT_UNIT_BITS;
    return min(high << 32 - shift | low >> shift, 0x7fffffffu);
}

void main() {
    uint group = group_number();
    if (group >= constants.groups) return;
    RadianceJob job = job_of(group, uint(RADIANCE_PASS_LOCAL));
    uint item = item_of(job, group, uint(RADIANCE_PASS_LOCAL));
    if (item >= job.local_receivers * uint(LOCAL_LIGHT_DIRECTIONS)) return;
    uvec2 layer = layer_reference(job.layer);
    uint row_bits = bits_at(job.bits, 24u);
    uint row = min(read_bits(layer, job.row_fields, item * row_bits, row_bits), job.rows - 1u);
    LightVector sum = vector_at(constants.sums, job.first_sum + job.clusters + row);
    WholeNormal normal = receiver_normal(layer, job, item / uint(LOCAL_LIGHT_DIRECTIONS));
    uvec3 value;
    for (int c = 0; c < 3; ++c) value[c] = direction_irradiance(normal, sum, c);
    write_word(layer_reference(job.local_layer), item, local_light_word(value));
}
