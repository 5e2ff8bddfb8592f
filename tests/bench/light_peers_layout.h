// What the CPU tells the passes that the light passes are measured against (light_peer_*.comp.glsl), shared by C++ and
// GLSL.
#ifndef CITYSTREAM_BENCH_LIGHT_PEERS_LAYOUT_H
#define CITYSTREAM_BENCH_LIGHT_PEERS_LAYOUT_H

#include "client/render/draw_layout.h"

#ifdef __cplusplus
namespace citystream::bench {
#endif

/* A workgroup a receiver. */
#define LIGHT_PEER_GROUP 64
/* Receivers in one row of a dispatch. */
#define LIGHT_PEER_ROW_GROUPS 32768
/* Light and sums: x, y and z of red, green and blue, two's complement, as the light passes have them. */
#define LIGHT_PEER_SUM_WORDS 9
/* Of an entry of the matrix: column | quarters << 16. */
#define LIGHT_PEER_QUARTERS_SHIFT 16

/* Push constants; addresses. */
struct LightPeerConstants {
    uint starts[2];  /* csr: first entry of each row, and the end */
    uint content[2]; /* csr: entries; bits: words of visibility, words_each of each receiver */
    uint light[2];   /* LIGHT_PEER_SUM_WORDS a texel */
    uint sums[2];    /* LIGHT_PEER_SUM_WORDS a receiver are written */
    uint receivers;
    uint rows_each;     /* csr: rows of a receiver */
    uint words_each;    /* bits */
    uint texels_across; /* bits */
};

#ifdef __cplusplus
static_assert(sizeof(LightPeerConstants) == 48);
}  // namespace citystream::bench
#endif

#endif
