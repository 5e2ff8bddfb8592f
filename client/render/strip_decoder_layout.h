// What the strip decoder (strip_decoder.h, shaders/strip_*.glsl) is told, shared by C++ and GLSL. 4-byte members only,
// so both lay them out alike.
#ifndef CITYSTREAM_CLIENT_STRIP_DECODER_LAYOUT_H
#define CITYSTREAM_CLIENT_STRIP_DECODER_LAYOUT_H

#include "client/render/scan_layout.h"
#include "codec/mesh/strip_layout.h"

#ifdef __cplusplus
namespace citystream::client {
#endif

/* The three streams of words of a mesh; the streams of all meshes of a batch are scanned as one, in segments. */
#define STRIP_KIND_CODES 0u      /* Simple-9 words */
#define STRIP_KIND_INCREMENTS 1u /* 32 references a word */
#define STRIP_KIND_STEPS 2u      /* 16 or 32 triangles a word */
#define STRIP_KINDS 3

/* Of a mesh of the batch; none is empty. */
struct StripRecord {
    uint layer[2];             /* reference as in TileConstants */
    uint part_at[STRIP_KINDS]; /* words of the layer where its streams begin */
    uint first[STRIP_KINDS];   /* words of the meshes before it */
    uint triangles;
    uint references;
    uint explicit_references;
    uint vertices;
    uint mode;        /* STRIP_MODE_* | prediction << STRIP_PREDICTION_BIT */
    uint explicit_at; /* words of the temporary memory: U, and for each word of INC the set bits before it */
    uint ranks_at;
    uint corners_at; /* words of the output: three a triangle */
};

/* Push constants of the strip_*.comp.glsl passes. */
struct StripConstants {
    uint records[2];
    uint temporary[2];
    uint corners[2];
    uint state[2];       /* of the scans of codes and increments; in passes of all three kinds */
    uint steps_state[2]; /* of the scan of steps, with look-back */
    uint record_count;
    uint words[STRIP_KINDS];
    uint blocks[STRIP_KINDS];
    uint reserved;
};

#ifdef __cplusplus
static_assert(sizeof(StripRecord) == 64 && sizeof(StripConstants) == 72);
}  // namespace citystream::client
#endif

#endif
