// Words of the maximum mip form of a facade map after the common head (facade_form_layout.h), shared by C++ and GLSL:
// D and M plain, texel by texel, and a pyramid of maxima of D.
#ifndef CITYSTREAM_CODEC_FACADE_MAX_MIP_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_MAX_MIP_LAYOUT_H

/* bits of a material (8 or 16) | levels << 8, 1..14: the last level is 1 x 1 */
#define FACADE_MAX_MIP_WORD_BITS 3
#define FACADE_MAX_MIP_WORD_MATERIALS 4 /* first word of M, a multiple of 4 */
/* words 5..7: 0. Words 8 + k: first word of level k, a multiple of 4; 0 beyond the last level. 16 words = 4 aligned
   groups. */
#define FACADE_MAX_MIP_WORD_LEVELS 8
#define FACADE_MAX_MIP_HEADER_WORDS 24 /* = first word of level 0 */
#define FACADE_MAX_MIP_MOST_LEVELS 14

/* Level k is a matrix of ceil(width / 2^k) x ceil(height / 2^k) int16, row by row from the bottom without padding, two
   a word, the lower half first. Level 0 is D; entry (x, y) of level k is the maximum of the texels x * 2^k <= u < (x +
   1) * 2^k (as far as there are any), v alike; an open texel counts as FACADE_OPEN_DISPLACEMENT. Levels lie in order,
   padded to 4 words, then M: entry y * width + x at bit (y * width + x) * bits. */

#endif
