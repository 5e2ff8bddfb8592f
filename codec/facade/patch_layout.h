// Word layout of a patch map after the head of facade_form_layout.h, shared by C++ and GLSL. FORMAT.md beside this file
// explains it. Sections, in this order: parts, patches, labels, bands, stripes.
#ifndef CITYSTREAM_CODEC_FACADE_PATCH_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_PATCH_LAYOUT_H

/* bands | transposed << 14 | two words a band << 15 | labels << 16 */
#define PATCH_WORD_COUNTS 3
#define PATCH_BAND_COUNT_MASK 0x3fffu
#define PATCH_TRANSPOSED_BIT 14
#define PATCH_WIDE_BANDS_BIT 15
#define PATCH_LABEL_COUNT_BIT 16
/* Field widths: first stripe (5) | stripes - 1 (4) | greatest displacement of a band (4) | content of a stripe (5) |
 * greatest displacement of a stripe (4) | log2 of a part unit's bytes (2) | part offset (4). Positions have as many
 * bits as the length or breadth - 1, label indexes as labels - 1. */
#define PATCH_WORD_WIDTHS 4
#define PATCH_FIRST_WIDTH_BIT 0
#define PATCH_COUNT_WIDTH_BIT 5
#define PATCH_BAND_MAX_WIDTH_BIT 9
#define PATCH_CONTENT_WIDTH_BIT 13
#define PATCH_STRIPE_MAX_WIDTH_BIT 18
#define PATCH_UNIT_BIT 22
#define PATCH_PART_WIDTH_BIT 24
#define PATCH_WORD_PATCHES 5 /* word of the first patch; the labels are the last words before the bands */
#define PATCH_WORD_BANDS 6   /* word of the first band; the stripes follow the bands */
/* Packed labels: unit of displacement, mm (16) | bits of its code (5) | bits of a material (5) | there are open ones */
#define PATCH_WORD_LABELS 7
#define PATCH_DEPTH_WIDTH_BIT 16
#define PATCH_MATERIAL_WIDTH_BIT 21
#define PATCH_HAS_OPEN_BIT 26 /* code 0 is open, the others are one more */
#define PATCH_PARTS_AT 8      /* word of the first part */

#define PATCH_NARROW_PART_BITS 7 /* a patch takes one word while its offsets have no more bits, two else */

/* Break list: inner breaks (5 bits) | width - PATCH_LEAST_BREAK_BITS (3 bits), then the breaks; at most 16 bytes. */
#define PATCH_MOST_BREAKS 31
#define PATCH_LEAST_BREAK_BITS 6
#define PATCH_BREAK_LIST_BITS 120
/* Label grid: the cells row by row. A folded one holds equal rows and columns once: a head of PATCH_FOLD_HEAD_BITS bits
 * (bits of a row's index (3) | bits of a column's index (3) << 3 | different columns - 1 (5) << 6), the indexes of the
 * rows and of the columns (none where their bits are 0: all are different), then the cells of the different ones. */
#define PATCH_FOLD_HEAD_BITS 11
#define PATCH_MOST_CELL_BITS 8 /* of a cell, at least 1 */
#define PATCH_MOST_MAX_BITS 8  /* of a greatest displacement */
#define PATCH_CELL_BITS_BIT 28 /* bits of a cell - 1 (3 bits): top of a patch's last word */
#define PATCH_FOLDED_BIT 31    /* the grid is folded */

#endif
