// Word layout of a mesh layer in GPU memory, shared by C++ and GLSL. RESIDENT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_MESH_RESIDENT_LAYOUT_H
#define CITYSTREAM_CODEC_MESH_RESIDENT_LAYOUT_H

#define RESIDENT_MAGIC 0x324d5343u /* "CSM2" */

/* Header words. Offsets are in words from the start of the layer. */
#define RESIDENT_WORD_MAGIC 0
#define RESIDENT_WORD_RANGES 1 /* number of ranges; their table follows the header */
#define RESIDENT_WORD_TRIANGLES 2
/* int32 grid units: coordinate = origin + position word, on each axis; multiples of 2^RESIDENT_CELL_BITS, less the
   bias of mesh_content.h */
#define RESIDENT_WORD_ORIGIN_X 3
#define RESIDENT_WORD_ORIGIN_Y 4
#define RESIDENT_WORD_ORIGIN_Z 5
#define RESIDENT_WORD_POSITIONS 6 /* offset: a precision buffer (precision_layout.h) of one component, to the end */
#define RESIDENT_WORD_CHARTS 7    /* charts; those of images come first, colours after them */
#define RESIDENT_WORD_IMAGES 8    /* charts of images */
#define RESIDENT_WORD_CHART_TABLE 9
#define RESIDENT_WORD_FACES 10
#define RESIDENT_WORD_FACE_TABLE 11 /* a face: chart, then octahedral code */
#define RESIDENT_WORD_BITS 12       /* bits a parameter of a normal | bits of a face's chart << 8 */
#define RESIDENT_WORD_FRAME 13      /* RESIDENT_FRAME_* of all images, or of each its own: then the last is ~0 */
#define RESIDENT_HEADER_WORDS 16

/* Chart table entry: the chart word, and of an image with a frame of its own that. */
#define RESIDENT_CHART_WORD 0 /* codec/chart_word_layout.h */
#define RESIDENT_CHART_FRAME 1

/* Where an image's texture coordinates are: in 2^-16 repeats base + (q << shift). */
#define RESIDENT_FRAME_BASE_U 0 /* int32 */
#define RESIDENT_FRAME_BASE_V 1
#define RESIDENT_FRAME_SHIFTS 2 /* of u | of v << 8 */
#define RESIDENT_FRAME_WORDS 3
#define RESIDENT_FRAMES_OF_THEIR_OWN 0xffffffffu

/* A range: triangles of one kind, drawn together. */
/* kind | flags << 8 | points of a prism << 16; of texture coordinates the bits of q_u << 16, of q_v << 24 */
#define RESIDENT_RANGE_KIND 0
#define RESIDENT_RANGE_TRIANGLES 1
#define RESIDENT_RANGE_FIRST_TRIANGLE 2 /* those of the ranges before it */
#define RESIDENT_RANGE_VERTICES 3       /* or prisms */
#define RESIDENT_RANGE_FIRST_POSITION 4 /* place in the precision buffer: of prisms; of points, three words each */
#define RESIDENT_RANGE_TOPOLOGY 5       /* offset: indices; strips; of prisms: distinct triangulations of tops */
#define RESIDENT_RANGE_TOPOLOGY_WORDS 6
/* of an index | of a face << 8 | of a prism's number of its top, or a point << 16 | zeros below q_u << 24, q_v << 28 */
#define RESIDENT_RANGE_BITS 7
#define RESIDENT_RANGE_FACES 8     /* offset: a field a triangle, or RESIDENT_RUN_*; a few a prism */
#define RESIDENT_RANGE_TEXCOORDS 9 /* offset: q_u, then q_v, without the zeros below, of each vertex */
#define RESIDENT_RANGE_NORMALS 10  /* offset: a code a vertex */
#define RESIDENT_RANGE_POINTS 11   /* offset: which point each vertex is, with RESIDENT_FLAG_POINTS */
#define RESIDENT_RANGE_WORDS 12

#define RESIDENT_KIND_PRISMS 0
#define RESIDENT_KIND_INDICES 1
#define RESIDENT_KIND_LOCAL_STRIPS 2
#define RESIDENT_KIND_STRIP_CODE 3
#define RESIDENT_FLAG_DRESSED 1u
#define RESIDENT_FLAG_TEXCOORDS 2u
#define RESIDENT_FLAG_NORMALS 4u    /* vertices have normals of their own */
#define RESIDENT_FLAG_WALL_BASES 8u /* prisms whose walls have bases of their own */
#define RESIDENT_FLAG_FLOORS 16u    /* prisms with floors */
#define RESIDENT_FLAG_POINTS 32u    /* several vertices share a point; else vertex i is point i */

#define RESIDENT_FLAG_RUNS 64u /* faces follow each other in the table; which triangles begin one is in FACES */

/* Of 32 triangles: bit t is set where triangle t > 0 of them has the next face; the face of the first one. */
#define RESIDENT_RUN_BEGINS 0
#define RESIDENT_RUN_FACE 1
#define RESIDENT_RUN_WORDS 2

/* Positions of a prism: base, top, then x and y of its points, then the bases of its walls if they have their own. */
#define RESIDENT_PRISM_BASE 0u
#define RESIDENT_PRISM_TOP 1u
#define RESIDENT_PRISM_POINTS 2u

/* The cells by which the rule that closes cracks takes distances (DropRule::common_dropped). */
#define RESIDENT_CELL_BITS 12

#endif
