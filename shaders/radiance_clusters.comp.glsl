#version 460
// First light pass (Sun et al. 2011, algorithm 2): what the columns of each cluster give, a thread a cluster.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_matrix.glsl"

void main() {
    uint group = group_number();
    if (group >= constants.groups) return;
    RadianceJob job = job_of(group, uint(RADIANCE_PASS_CLUSTERS));
    uint cluster = item_of(job, group, uint(RADIANCE_PASS_CLUSTERS));
    if (cluster >= job.clusters) return;
    uvec2 layer = layer_reference(job.layer);
    uint start_bits = bits_at(job.start_bits, 0u);
    uint begin = start_of(layer, job.term_starts, cluster, job.clusters, start_bits);
    uint end = min(start_of(layer, job.term_starts, cluster + 1u, job.clusters, start_bits), job.terms);
    uint column_bits = bits_at(job.bits, 0u);
    uint term_bits = column_bits + bits_at(job.bits, 8u);
    uint column_mask = (1u << column_bits) - 1u;
    uint least = bits_at(job.start_bits, 16u) - 128u;
    uvec3 sum = uvec3(0u);
    for (uint i = begin; i < end; ++i) {
        uint term = read_bits(layer, job.term_fields, i * term_bits, term_bits);
        uint column = min(term & column_mask, job.columns - 1u);
        sum += (least + (term >> column_bits)) * sum_at(constants.light, column);
    }
    set_sum(job.first_sum + cluster, sum);
}
