// Word layout of a decoded atlas layer whose charts are packed into pages, shared by C++ and GLSL. FORMAT.md beside
// this file explains it.
#ifndef CITYSTREAM_CODEC_ATLAS_PAGE_LAYOUT_H
#define CITYSTREAM_CODEC_ATLAS_PAGE_LAYOUT_H

#define PAGES_MAGIC 0x31505343u /* "CSP1" */

/* Step 0: header words, page table, chart table, then the blocks of every page's coarsest level. Each later step holds
 * the next finer level of every page. */
#define PAGES_WORD_MAGIC 0
#define PAGES_WORD_CHART_COUNT 1
#define PAGES_WORD_PAGE_COUNT 2
#define PAGES_WORD_MIPS                                                                          \
    3 /* M, levels are 0 (the finest) to M; bits 8..15: border of every chart, texels of level 0 \
       */
#define PAGES_HEADER_WORDS 4
#define PAGES_MOST_MIPS 7

/* Page table entry, at PAGES_HEADER_WORDS + PAGES_PAGE_WORDS * page. */
#define PAGES_PAGE_SIZE 0   /* width | height << 16 of level 0: multiples of 4 * 2^M, up to 4096 */
#define PAGES_PAGE_BLOCKS 1 /* 8 words: where the BC1 blocks of level m begin, words from the start of the layer */
#define PAGES_PAGE_WORDS 9

/* Chart table entry, behind the page table. */
#define PAGES_CHART_U \
    0 /* packed coordinate (wrap_coordinate_layout.h) at place 0; a flat chart's colour: r | g << 8 | b << 16 */
#define PAGES_CHART_V 1
#define PAGES_CHART_FLAGS 2 /* bits 16..31: page */
#define PAGES_CHART_WORDS 3
#define PAGES_CHART_REPEAT_U 1u
#define PAGES_CHART_REPEAT_V 2u
#define PAGES_CHART_FLAT 4u

#endif
