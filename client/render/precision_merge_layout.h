// What the CPU tells precision_merge.comp.glsl, shared by C++ and GLSL. 4-byte members only.
#ifndef CITYSTREAM_CLIENT_PRECISION_MERGE_LAYOUT_H
#define CITYSTREAM_CLIENT_PRECISION_MERGE_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

#define PRECISION_MERGE_GROUP 64
#define PRECISION_MERGE_MOST_PLANES 32
/* Groups in one row of the dispatch; more go into further rows (65,535 is what every device has). */
#define PRECISION_MERGE_ROW_GROUPS 32768

/* One buffer that goes to another level. References as in TileConstants. Where the buffer lies behind other words of
   its layer, source and target are the layer's, and those words are copied. */
struct PrecisionMergeJob {
    uint source[2];
    uint target[2];
    uint planes[2];  /* 0 where none are added */
    uint first_word; /* of the target, in the numbering of all words of the dispatch */
    uint to_level;
    uint words_before;                                /* of the layer, before the buffer */
    uint plane_begin[PRECISION_MERGE_MOST_PLANES];    /* word at which plane l of the words begins, by l */
    uint plane_vertices[PRECISION_MERGE_MOST_PLANES]; /* that it has bits of */
};

struct PrecisionMergeConstants {
    uint jobs[2]; /* address of PrecisionMergeJob[job_count], by first_word */
    uint job_count;
    uint words; /* of all targets, with those before the buffers */
};

#ifdef __cplusplus
static_assert(sizeof(PrecisionMergeJob) == 36 + 256 && sizeof(PrecisionMergeConstants) == 16);
}  // namespace citystream::client
#endif

#endif
