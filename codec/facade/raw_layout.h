// Words of the raw form of a facade map after the common head (facade_form_layout.h), shared by C++ and GLSL: the
// matrices D, M and, optionally, A (index of each texel's free box) plain, texel by texel.
#ifndef CITYSTREAM_CODEC_FACADE_RAW_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_RAW_LAYOUT_H

/* bits of a material (8 or 16) | bits of a box index (0: no A and no boxes, 16, 32) << 8 */
#define FACADE_RAW_WORD_BITS 3
/* First words of the sections, multiples of 4, in this order and without gaps (but the padding to 4 words). Every
   matrix is stored row by row from the bottom without padding between rows: entry i = y * width + x lies at bit i *
   bits of its section, least significant first. */
#define FACADE_RAW_WORD_DISPLACEMENTS 4 /* int16 */
#define FACADE_RAW_WORD_MATERIALS 5
#define FACADE_RAW_WORD_BOX_INDICES 6 /* each less than the box count, of a box that holds the texel */
#define FACADE_RAW_WORD_BOXES 7
#define FACADE_RAW_WORD_BOX_COUNT 8
/* words 9..11: 0 */
#define FACADE_RAW_HEADER_WORDS 12 /* = first word of the displacements */

/* A free box, the same record in the raw, singular value and binary forms: its sides in texels. Its bottom is D of the
   texel at which it is looked up; above that no texel of the box has relief. Two boxes in an aligned group of 4 words.
 */
#define FACADE_BOX_WORD_X 0 /* x0 | x1 << 16: x0 <= texel x < x1 */
#define FACADE_BOX_WORD_Y 1 /* y0 | y1 << 16 */
#define FACADE_BOX_WORDS 2

#endif
