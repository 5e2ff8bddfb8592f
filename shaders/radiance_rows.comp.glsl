#version 460
// Second light pass (Sun et al. 2011, algorithm 2): what the clusters of each row give, a thread a row.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/radiance_sums.glsl"

void main() {
    SumWork work;
    if (!sum_work(uint(RADIANCE_PASS_ROWS), work)) return;
    RadianceJob job = work.job;
    uint link_bits = bits_at(job.bits, 16u);
    LightVector sum = no_light();
    for (uint i = work.begin; i < work.end; ++i) {
        uint cluster = min(read_bits(work.layer, job.link_fields, i * link_bits, link_bits), job.clusters - 1u);
        add_scaled(sum, 1u, vector_at(constants.sums, job.first_sum + cluster));
    }
    set_sum(job.first_sum + job.clusters + work.item, sum);
}
