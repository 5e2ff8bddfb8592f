// What the CPU tells the light passes (radiance_*.comp.glsl), shared by C++ and GLSL. 4-byte members only.
#ifndef CITYSTREAM_CLIENT_RADIANCE_PASSES_LAYOUT_H
#define CITYSTREAM_CLIENT_RADIANCE_PASSES_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

#define RADIANCE_PASS_GROUP 64
/* Groups in one row of a dispatch; more go into further rows (65,535 is what every device has). */
#define RADIANCE_PASS_ROW_GROUPS 32768

#define RADIANCE_PASS_CLUSTERS 0  /* sums of each cluster's terms */
#define RADIANCE_PASS_ROWS 1      /* sums of each row's clusters */
#define RADIANCE_PASS_RECEIVERS 2 /* irradiance of each receiver */
#define RADIANCE_PASS_LOCAL 3     /* of each receiver on a wall by direction, where it is asked for */
#define RADIANCE_PASSES 4

/* Light and sums, each a vector of red, green and blue: three words along x, three along y, three along z, two's
   complement (codec/radiance/source_light.h). */
#define RADIANCE_SUM_WORDS 9

/* One layer whose receivers are lit. Words are counted from the layer's first. */
struct RadianceJob {
    uint layer[2];                     /* reference as in TileConstants */
    uint local_layer[2];               /* of the words of local light (codec/radiance/local_light.h) */
    uint local_receivers;              /* that have such words; 0: the layer has no local light */
    uint first_group[RADIANCE_PASSES]; /* in the numbering of all groups of the batch */
    uint irradiance_word;
    uint receivers, locals, columns, rows, clusters, terms, links;
    uint term_starts, link_starts, term_fields, link_fields, row_fields; /* words */
    uint bits, start_bits;                                               /* as in the matrix's header */
    uint first_sum; /* of the clusters' sums; those of the rows follow */
    uint unused;    /* 8 bytes are a job's alignment */
};

/* Push constants of all passes. */
struct RadiancePassConstants {
    uint jobs[2];  /* address of RadianceJob[job_count], by first_group */
    uint light[2]; /* of the light's words */
    uint sums[2];
    uint job_count;
    uint groups; /* of this pass */
};

#ifdef __cplusplus
static_assert(sizeof(RadianceJob) == 104 && sizeof(RadiancePassConstants) == 32);
}  // namespace citystream::client
#endif

#endif
