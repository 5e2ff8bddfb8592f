// Word layout of a quotient map after the head of facade_form_layout.h, shared by C++ and GLSL, and of the sections
// that the tiled map has too. FORMAT.md beside this file explains it. A group is four words at a multiple of 16 bytes:
// one load. Sections begin at groups, in this order: column breaks, row breaks, block maxima, and then of the quotient
// column classes, row classes, labels, cells.
#ifndef CITYSTREAM_CODEC_FACADE_QUOTIENT_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_QUOTIENT_LAYOUT_H

#define RUN_BREAKS_GROUP 2 /* first group of the column breaks */

/* Breaks of one axis, a group for RUN_GROUP_TEXELS texels: bit i of words 0, 1 and the low 24 bits of word 2: a run
 * begins at texel i of the group (texel 0 of the map begins one). Word 3: breaks before the group (13 bits) | the last
 * of them << 13 (13 bits, 0 if none) | low 6 bits of the first break behind the group (the size if none) << 26; the top
 * byte of word 2: its 8 high bits. So one load gives a texel's run and where it begins and ends. */
#define RUN_GROUP_TEXELS 88
#define RUN_LAST_BITS 24
#define RUN_RANK_BITS 13
#define RUN_BEFORE_BIT 13
#define RUN_BEHIND_LOW_BIT 26
#define RUN_BEHIND_LOW_BITS 6
#define RUN_BEHIND_HIGH_BIT 24

/* Greatest displacement of each block of 2^BLOCK_LOG2 x 2^BLOCK_LOG2 texels, row by row from the bottom, a byte each:
 * least displacement of the map + byte * ceil(range / 255), rounded up; 0 of a block that is all open. */
#define BLOCK_LOG2 5
#define BLOCK_MAX_LEVELS 255

/* Labels as numbers: steps of displacement above the least (low bits; one more than the greatest has: open), material.
 */

/* columns of the label grid (distinct columns) | rows << 14 | cells hold label numbers (else indexes) << 28 | fields of
 * cells may cross groups << 29 */
#define QUOTIENT_WORD_CLASSES 3
#define QUOTIENT_CLASS_BITS 14
#define QUOTIENT_DIRECT_BIT 28
#define QUOTIENT_DENSE_BIT 29
/* Field widths: column class (4) | row class (4) << 4 | cell (6) << 8 | displacement of a label number (5) << 14 */
#define QUOTIENT_WORD_WIDTHS 4
#define QUOTIENT_WORD_CLASS_GROUPS 5 /* first group of the column classes | of the row classes << 16 */
#define QUOTIENT_WORD_LABELS 6 /* cells are indexes: first group of the labels; else the step of displacements, mm */
#define QUOTIENT_WORD_CELLS 7  /* first group of the cells */

#endif
