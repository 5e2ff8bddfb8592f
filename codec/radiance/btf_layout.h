// Words of a facade map's bidirectional texture function (BTF) in GPU memory, shared by C++ and GLSL. FORMAT.md beside
// this file explains them.
#ifndef CITYSTREAM_CODEC_RADIANCE_BTF_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_BTF_LAYOUT_H

#define BTF_MAGIC 0x31425343u /* "CSB1" */

#define BTF_WORD_MAGIC 0
#define BTF_WORD_SHAPE 1    /* log2 of the patch's side | views across << 8 | has coverage << 16 */
#define BTF_WORD_SLOTS 2    /* palette slots that the map uses, a bit each */
#define BTF_WORD_RECORDS 4  /* offset */
#define BTF_WORD_COVERAGE 5 /* offset; 0: nothing is open */
#define BTF_WORD_SCALES 6   /* two floats: texels of the map a metre along u and v */

#define BTF_DIRECTIONS 64 /* 8 x 8, as a relief mask has them */
#define BTF_DIRECTIONS_ACROSS 8

/* Tables of directions, four words each: unit vector (float bits); of light: mean cosine | share of the hemisphere <<
   16 in 2^-16 of what is nearest to it; of views: 0. Those of light come first, then views across * views across. */
#define BTF_DIRECTION_TABLE 8
#define BTF_DIRECTION_WORDS 4
#define BTF_VIEW_TABLE 264 /* BTF_DIRECTION_TABLE + BTF_DIRECTIONS * BTF_DIRECTION_WORDS */

/* Records: by view, then by texel of the patch from the finest mip to the one of a single texel, each row by row from
   the bottom. A record: a byte a light direction, then a byte a palette slot. Texels of a view are filled up to a
   multiple of four. Coverage: a byte a record. */
#define BTF_RECORD_WORDS 20
#define BTF_RECORD_SLOTS 16 /* words before those of the slots */
#define BTF_SLOTS 16

#define BTF_LEAST_PATCH_LOG2 2
#define BTF_MOST_PATCH_LOG2 6
#define BTF_LEAST_VIEWS_ACROSS 4
#define BTF_MOST_VIEWS_ACROSS 16

/* Rays of a texel of the finest mip: a rank-1 lattice. */
#define BTF_RAYS 16
#define BTF_RAY_GENERATOR 7

#endif
