// What the first two light passes (Sun et al. 2011, algorithm 2) begin with: a thread's cluster and its terms, or a thread's row and its links.
#ifndef CITYSTREAM_RADIANCE_SUMS_GLSL
#define CITYSTREAM_RADIANCE_SUMS_GLSL

#include "shaders/radiance_matrix.glsl"

struct SumWork {
    RadianceJob job;
    uvec2 layer;
    uint item;        // cluster or row
    uint begin, end;  // its terms or links
};

// False: the thread has none. `pass`: RADIANCE_PASS_CLUSTERS or RADIANCE_PASS_ROWS.
bool sum_work(uint pass, out SumWork work) {
    uint group = group_number();
    if (group >= constants.groups) return false;
    work.job = job_of(group, pass);
    work.item = item_of(work.job, group, pass);
    bool of_rows = pass == uint(RADIANCE_PASS_ROWS);
    uint count = of_rows ? work.job.rows : work.job.clusters;
    if (work.item >= count) return false;
    work.layer = layer_reference(work.job.layer);
    uint starts = of_rows ? work.job.link_starts : work.job.term_starts;
    uint start_bits = bits_at(work.job.start_bits, of_rows ? 8u : 0u);
    work.begin = start_of(work.layer, starts, work.item, count, start_bits);
    work.end = min(start_of(work.layer, starts, work.item + 1u, count, start_bits), of_rows ? work.job.links : work.job.terms);
    return true;
}

#endif
