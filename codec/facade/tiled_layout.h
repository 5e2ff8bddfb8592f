// Word layout of a tiled map after the head of facade_form_layout.h, shared by C++ and GLSL. Run breaks and block
// maxima are those of quotient_layout.h; behind them, each from a group on: tile records, patterns, palettes. FORMAT.md
// beside this file explains it.
#ifndef CITYSTREAM_CODEC_FACADE_TILED_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_TILED_LAYOUT_H

#define TILE_SIDE_LOG2 3 /* cells of the run grid a tile: 8 x 8 */

/* tiles a row (11 bits) | bits of a record's pattern << 11 (5) | of its palette << 16 (5) | of a label number << 21 (6)
 * | of the displacement in it << 27 (5) */
#define TILED_WORD_WIDTHS 3
#define TILED_WORD_RECORDS 4  /* first group of the records */
#define TILED_WORD_PATTERNS 5 /* of the patterns */
#define TILED_WORD_PALETTES 6 /* of the palettes: label numbers (quotient_layout.h) */
#define TILED_WORD_STEP 7     /* of displacements in label numbers, millimetres */

/* Record: bits of a pattern's cell (0..6) | pattern, in units of 64 bits | first entry of the palette. */
#define TILE_CELL_BITS_BITS 3
#define TILE_PATTERN_UNIT_LOG2 6

#endif
