// Words of a facade map's relief mask in GPU memory, shared by C++ and GLSL. FORMAT.md beside this file explains them.
#ifndef CITYSTREAM_CODEC_RADIANCE_RELIEF_MASK_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_RELIEF_MASK_LAYOUT_H

#define RELIEF_MASK_MAGIC 0x314b5343u /* "CSK1" */

#define RELIEF_MASK_WORD_MAGIC 0
#define RELIEF_MASK_WORD_MAP 1      /* width | height << 16 of the facade map, its texels */
#define RELIEF_MASK_WORD_SIDE 2     /* log2 of a mask texel's side in texels of the map */
#define RELIEF_MASK_WORD_SURFACES 3 /* how many follow the mask texels */
#define RELIEF_MASK_WORD_SCALES 4   /* two floats: texels of the map a metre along u and v */

#define RELIEF_DIRECTIONS 64 /* 8 x 8 local directions of the wall's frame (u, v, w) */
#define RELIEF_DIRECTIONS_ACROSS 8
/* Of each direction two words: x | y << 16, z; int16 in units of 2^-14. */
#define RELIEF_MASK_DIRECTIONS 8
#define RELIEF_MASK_DIRECTION_WORDS 2

/* Sides of relief, by their normals. */
#define RELIEF_FACE_FRONT 0 /* +w */
#define RELIEF_FACE_RIGHT 1 /* +u */
#define RELIEF_FACE_LEFT 2  /* -u */
#define RELIEF_FACE_UPPER 3 /* +v */
#define RELIEF_FACE_LOWER 4 /* -v */
#define RELIEF_FACES 5
/* Of each face 64 weights of 16 bits, two a word, in units of 2^-16. */
#define RELIEF_MASK_WEIGHTS 136
#define RELIEF_MASK_FACE_WORDS 32

/* A word each, rows from the bottom: number of its first surface | how many it has << RELIEF_MASK_COUNT_SHIFT. */
#define RELIEF_MASK_TEXELS 296
#define RELIEF_MASK_COUNT_SHIFT 24
#define RELIEF_MASK_MOST_TEXELS 16384

/* Of a surface, after the mask texels: directions 0..31, directions 32..63 (set: free of the relief), and the label of
   the map's texel where its rays start. Before the rays are cast the first word is that texel, x | y << 16. */
#define RELIEF_MASK_SURFACE_WORDS 3
/* Of a mask texel. */
#define RELIEF_MASK_MOST_SURFACES 3

#endif
