// Word layout of a tile's receivers in GPU memory, shared by C++ and GLSL. RECEIVERS.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_RADIANCE_RECEIVER_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_RECEIVER_LAYOUT_H

#define RECEIVER_MAGIC 0x31525343u /* "CSR1" */

/* Header words. Offsets are in words from the start. */
#define RECEIVER_WORD_MAGIC 0
#define RECEIVER_WORD_COUNT 1   /* receivers: their entries are the last words */
#define RECEIVER_WORD_SPACING 2 /* log2 of the spacing in grid units: RECEIVER_LEAST_SPACING..RECEIVER_MOST_SPACING */
#define RECEIVER_WORD_ENTRIES 3 /* offset of the receivers */
#define RECEIVER_WORD_CLASSES 4 /* of each of the classes RECEIVER_CLASS_* */
#define RECEIVER_CLASSES 6      /* +x -x +y -y +z -z */
#define RECEIVER_DOWNWARDS 5    /* -z: those that look down see the ground, and stand in for none that does not */

#define RECEIVER_CLASS_FIRST_ROW 0 /* int32: j of its first row */
#define RECEIVER_CLASS_ROWS 1
#define RECEIVER_CLASS_ROW_TABLE 2 /* offset */
#define RECEIVER_CLASS_DEPTH 3     /* int32, grid units: what a depth of 0 stands for; a multiple of the spacing */
#define RECEIVER_CLASS_WORDS 4

#define RECEIVER_HEADER_WORDS 28

/* A row: columns with one j. */
#define RECEIVER_ROW_COLUMNS 0 /* i of its first column (int16) | number of columns << 16 */
#define RECEIVER_ROW_BEGINS 1  /* offset: for each column, and once more at the end, 16 bits */
#define RECEIVER_ROW_FIRST 2   /* the row's first receiver, to which the 16 bits are added */
#define RECEIVER_ROW_WORDS 3

/* A receiver: depth in spacings / 64 (16 bits) | int8 tilts on the column's axes << 16 and << 24 */
#define RECEIVER_DEPTH_BITS 6 /* of a spacing */
#define RECEIVER_TILT_ONE 127

#define RECEIVER_LEAST_SPACING 6
#define RECEIVER_MOST_SPACING 20
#define RECEIVER_MOST 1048576u
#define RECEIVER_MOST_COLUMN 32767 /* i and j, from -this on */

/* A receiver serves a point when its depth is off by no more units than this, and their normals' cosine squared is
   greater than RECEIVER_COSINE_SQUARED: half a spacing and 30 degrees, with room for rounding. */
#define RECEIVER_TOLERANCE 34.0
#define RECEIVER_COSINE_SQUARED 0.75
/* One that stands in for a surface too small for receivers: within a spacing, and not turned away by more than a right
   angle. */
#define RECEIVER_LOOSE_TOLERANCE 64.0
/* Of those that may stand in the one is taken that is least off in depth and turned away: with cosine c between the
   normals, 1 - c |c| times so many units. */
#define RECEIVER_TURNED 64.0
/* A column with more receivers than this is searched by halving until so many are left. */
#define RECEIVER_FEW 4

#endif
