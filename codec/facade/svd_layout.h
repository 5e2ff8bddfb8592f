// Words of the singular value form of a facade map after the common head (facade_form_layout.h), shared by C++ and
// GLSL: each of D, M and A as a product of two matrices of float32, and the boxes that A counts.
#ifndef CITYSTREAM_CODEC_FACADE_SVD_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_SVD_LAYOUT_H

#define FACADE_SVD_WORD_BOXES 3 /* first word of the boxes (FACADE_BOX_WORDS each, raw_layout.h), a multiple of 4 */
/* Three descriptors, one aligned group of 4 words each: D, M, A. */
#define FACADE_SVD_WORD_DISPLACEMENT 4
#define FACADE_SVD_WORD_MATERIAL 8
#define FACADE_SVD_WORD_BOX_INDEX 12
#define FACADE_SVD_WORD_BOX_COUNT 16
#define FACADE_SVD_WORD_TERMS 17 /* .. 19: singular values kept for D, M, A; in groups of 4: G of the descriptor */
#define FACADE_SVD_HEADER_WORDS 20

/* Descriptor. */
#define FACADE_SVD_MAP_ROWS 0    /* first word of X: `height` rows of groups, a multiple of 4 */
#define FACADE_SVD_MAP_COLUMNS 1 /* first word of Y: `width` rows of groups, a multiple of 4 */
#define FACADE_SVD_MAP_GROUPS 2  /* G: groups of 4 floats in a row of X or Y, 0 when all entries are equal */
#define FACADE_SVD_MAP_LEAST 3   /* int32, added to the sum; -32768..FACADE_SVD_GREATEST */
#define FACADE_SVD_MAP_WORDS 4

/* Entry (x, y): sum = 0.0; for k = 0..4G-1 in this order: sum = sum + X[y][k] * Y[x][k] (X holds the singular value,
   the terms beyond the last kept are 0); entry = least + int(floor(clamp(sum, 0.0, FACADE_SVD_GREATEST) + 0.5)). All in
   float32, a fused multiply-add or not. Box indices are used after min(index, box count - 1).
   Floats are finite and not greater than FACADE_SVD_GREATEST, so that no sum is infinite or not a number. */
#define FACADE_SVD_GREATEST 16777215.0

#endif
