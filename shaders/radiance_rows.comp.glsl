#version 460
// Second light pass (Sun et al. 2011, algorithm 2): what the clusters of each row give, a thread a row.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_matrix.glsl"

void main() {
    uint group = group_number();
    if (group >= constants.groups) return;
    RadianceJob job = job_of(group, uint(RADIANCE_PASS_ROWS));
    uint row = item_of(job, group, uint(RADIANCE_PASS_ROWS));
    if (row >= job.rows) return;
    uvec2 layer = layer_reference(job.layer);
    uint start_bits = bits_at(job.start_bits, 8u);
    uint begin = start_of(layer, job.link_starts, row, job.rows, start_bits);
    uint end = min(start_of(layer, job.link_starts, row + 1u, job.rows, start_bits), job.links);
    uint link_bits = bits_at(job.bits, 16u);
    uvec3 sum = uvec3(0u);
    for (uint i = begin; i < end; ++i) {
        uint cluster = min(read_bits(layer, job.link_fields, i * link_bits, link_bits), job.clusters - 1u);
        sum += sum_at(constants.sums, job.first_sum + cluster);
    }
    set_sum(job.first_sum + job.clusters + row, sum);
}
