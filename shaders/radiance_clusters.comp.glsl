#version 460
// First light pass (Sun et al. 2011, algorithm 2): what the columns of each cluster give, a thread a cluster.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_sums.glsl"

void main() {
    SumWork work;
    if (!sum_work(uint(RADIANCE_PASS_CLUSTERS), work)) return;
    RadianceJob job = work.job;
    uint column_bits = bits_at(job.bits, 0u);
    uint term_bits = column_bits + bits_at(job.bits, 8u);
    uint column_mask = (1u << column_bits) - 1u;
    uint least = bits_at(job.start_bits, 16u) - 128u;
    LightVector sum = no_light();
    for (uint i = work.begin; i < work.end; ++i) {
        uint term = read_bits(work.layer, job.term_fields, i * term_bits, term_bits);
        uint column = min(term & column_mask, job.columns - 1u);
        add_scaled(sum, least + (term >> column_bits), vector_at(constants.light, column));
    }
    set_sum(job.first_sum + work.item, sum);
}
