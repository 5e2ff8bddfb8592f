// Word layouts of facade maps and of a tile's facade layer, shared by C++ and GLSL. FORMAT.md beside this file explains
// them.
#ifndef CITYSTREAM_CODEC_FACADE_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_LAYOUT_H

#define FACADE_MAP_MAGIC 0x31465343u   /* "CSF1" */
#define FACADE_LAYER_MAGIC 0x31505343u /* "CSP1" */

/* A facade map: the displacement and material matrices on the grid of their distinct runs. Lengths are in texels (1
 * cm). */
#define FACADE_MAP_WORD_MAGIC 0
#define FACADE_MAP_WORD_CELLS 1 /* columns of cells | rows of cells << 16 */
#define FACADE_MAP_WORD_SIZE 2  /* width | height << 16, texels, 1..8192 */
/* least displacement | greatest << 16, int16 millimetres, outwards positive */
#define FACADE_MAP_WORD_DEPTHS 3
#define FACADE_MAP_WORD_LABELS 4    /* label count | bits a cell << 16 */
#define FACADE_MAP_WORD_OFFSETS 5   /* offset of y breaks | offset of labels << 16 */
#define FACADE_MAP_WORD_CELL_DATA 6 /* offset of the packed labels, row by row from the bottom */
/* x breaks follow: cells + 1 uint16, two a word, first 0, last = size; then y breaks; labels; cells */
#define FACADE_MAP_HEADER_WORDS 8
/* Label: displacement int16 mm | material slot << 16. */

/* Facade layer of a tile: header, palette entries, placements. */
#define FACADE_LAYER_WORD_MAGIC 0
#define FACADE_LAYER_WORD_PLACEMENT_COUNT 1
#define FACADE_LAYER_WORD_PALETTE_COUNT 2
#define FACADE_LAYER_WORD_PLACEMENTS 3 /* offset */
#define FACADE_LAYER_WORD_PALETTES 4   /* offset */
#define FACADE_LAYER_HEADER_WORDS 8

/* int32 grid units, tile-relative: lower left corner of the wall seen from outside */
#define FACADE_PLACEMENT_ORIGIN_X 0
#define FACADE_PLACEMENT_ORIGIN_Y 1
#define FACADE_PLACEMENT_ORIGIN_Z 2
#define FACADE_PLACEMENT_ALONG_X 3 /* int32 grid units: from lower left to lower right corner */
#define FACADE_PLACEMENT_ALONG_Y 4
#define FACADE_PLACEMENT_HEIGHT 5 /* grid units; the map is stretched over along x height */
#define FACADE_PLACEMENT_MAP 6    /* index in the city's facade dictionary */
#define FACADE_PLACEMENT_PALETTE 7
#define FACADE_PLACEMENT_WORDS 8

#define FACADE_PALETTE_SLOTS 16
/* Palette: FACADE_PALETTE_SLOTS entries of 2 words: atlas chart index; metres a repeat of that chart's image (float
 * bits). */
#define FACADE_PALETTE_ENTRY_WORDS 2
#define FACADE_PALETTE_WORDS (FACADE_PALETTE_SLOTS * FACADE_PALETTE_ENTRY_WORDS)

#endif
