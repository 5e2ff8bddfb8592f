// Word layout of a tile's facade layer, shared by C++ and GLSL. FORMAT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_FACADE_LAYOUT_H
#define CITYSTREAM_CODEC_FACADE_LAYOUT_H

#define FACADE_LAYER_MAGIC 0x31505343u /* "CSP1" */

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
