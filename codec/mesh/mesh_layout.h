// Word layout of a decoded mesh layer, shared by C++ and GLSL. FORMAT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_MESH_LAYOUT_H
#define CITYSTREAM_CODEC_MESH_LAYOUT_H

#define MESH_MAGIC 0x314d5343u /* "CSM1" */
#define MESH_PLANES_MAGIC 0x3150534du

/* Step 0: header words. Offsets are in words from the start of the layer. */
#define MESH_WORD_MAGIC 0
#define MESH_WORD_VERTEX_COUNT 1
#define MESH_WORD_TRIANGLE_COUNT 2
/* first triangle of the flat stand-ins of facades, last part of the triangle list */
#define MESH_WORD_DRESSED_BEGIN 3
/* int32 grid units from the tile's minimum corner and base height; multiple of 2^dropped(step 0) */
#define MESH_WORD_ORIGIN_X 4
#define MESH_WORD_ORIGIN_Y 5
#define MESH_WORD_ORIGIN_Z 6
/* index bits | chart bits << 8 | position bits of step 0 << 16 | low bits dropped at step 0 << 24 */
#define MESH_WORD_WIDTHS 7
#define MESH_WORD_CHART_COUNT 8
#define MESH_WORD_CHART_TABLE 9 /* offset: 4 words a chart */
#define MESH_WORD_INDICES 10    /* offset: 3 * triangles fields of index bits */
#define MESH_WORD_CHARTS 11     /* offset: one field of chart bits a triangle */
/* offset: 16 bits a vertex: octahedral u | v << 8, two vertices a word */
#define MESH_WORD_NORMALS 12
#define MESH_WORD_TEXCOORDS 13 /* offset: one word a vertex: q_u | q_v << 16 */
#define MESH_WORD_POSITIONS 14 /* offset: 3 fields a vertex */
#define MESH_HEADER_WORDS 16

/* Chart table entry: texture coordinate in 2^-16 repeats = base + (q << shift). */
#define MESH_CHART_BASE_U 0 /* int32, 2^-16 repeats */
#define MESH_CHART_BASE_V 1
#define MESH_CHART_SHIFTS 2 /* shift of u | shift of v << 8 */
#define MESH_CHART_WORD 3   /* codec/chart_word_layout.h */
#define MESH_CHART_WORDS 4

/* Steps 1..: header of a block of lower bit planes. */
#define MESH_PLANES_WORD_MAGIC 0
#define MESH_PLANES_WORD_WIDTHS 1 /* bits of this step | low bits still dropped << 8 */
#define MESH_PLANES_HEADER_WORDS 2

#define MESH_MAX_STEPS 4

#endif
