// Words of the binary factor form of a facade map after the common head (facade_form_layout.h), shared by C++ and GLSL:
// each of D, M and A as X diag(sigma) Y^T with bits in X and Y, and the boxes that A counts.
#ifndef CITYSTREAM_CODEC_FACADE_BINARY_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_BINARY_LAYOUT_H

#define FACADE_BINARY_WORD_FLAGS 3
/* Rows of X and Y are stored once and found through index vectors; the first term that covers an entry is its value
   (terms may overlap). Without the flag: one row of X a texel row, one row of Y a texel column, and terms do not
   overlap, so that the sum of the paper's listing has at most one addend. Stopping at the first hit is right for both.
 */
#define FACADE_BINARY_FLAG_SHARED 1
/* Three descriptors, two aligned groups of 4 words each: D, M, A. */
#define FACADE_BINARY_WORD_DISPLACEMENT 4
#define FACADE_BINARY_WORD_MATERIAL 12
#define FACADE_BINARY_WORD_BOX_INDEX 20
/* first word of the boxes (FACADE_BOX_WORDS each, raw_layout.h), a multiple of 4 */
#define FACADE_BINARY_WORD_BOXES 28
#define FACADE_BINARY_WORD_BOX_COUNT 29
/* words 30, 31: 0 */
#define FACADE_BINARY_HEADER_WORDS 32

/* Descriptor. */
#define FACADE_BINARY_MAP_X 0         /* first word of X: rows of ROW_WORDS words, bit b of word w: term 32 w + b */
#define FACADE_BINARY_MAP_Y 1         /* first word of Y, alike */
#define FACADE_BINARY_MAP_SIGMA 2     /* first word of sigma, one uint32 a term */
#define FACADE_BINARY_MAP_ROW_WORDS 3 /* W = ceil(terms / 32); 0 when all entries are equal */
#define FACADE_BINARY_MAP_BASE 4      /* uint32, added to sigma modulo 2^32; the value of what no term covers */
#define FACADE_BINARY_MAP_X_INDEX 5   /* shared: first word of `height` halves, the row of X of a texel row; else 0 */
#define FACADE_BINARY_MAP_Y_INDEX 6   /* shared: first word of `width` halves, the row of Y of a texel column; else 0 */
#define FACADE_BINARY_MAP_TERMS 7
#define FACADE_BINARY_MAP_WORDS 8

/* Entry (x, y), with i = y and j = x, or, shared, i = half y of the X index and j = half x of the Y index:
   for w = 0..W-1: bits = X[i * W + w] & Y[j * W + w]; if bits != 0: entry = int(base + sigma[32 w + lowest set bit of
   bits]), done. None: entry = int(base). Bits of terms that do not exist are 0. Box indices are used after
   min(uint(index), box count - 1). */

#endif
