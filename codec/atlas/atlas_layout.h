// Word layout of a decoded atlas layer, shared by C++ and GLSL. FORMAT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_ATLAS_LAYOUT_H
#define CITYSTREAM_CODEC_ATLAS_LAYOUT_H

#define ATLAS_MAGIC 0x31415343u /* "CSA1" */

/* Step 0: header words, then the chart table, then the blocks of the coarsest mips. Offsets are in words from the start
 * of the layer. */
#define ATLAS_WORD_MAGIC 0
#define ATLAS_WORD_CHART_COUNT 1
#define ATLAS_WORD_MIP_COUNT 2 /* of the largest chart: mip 0 is the finest */
#define ATLAS_WORD_STEP0_MIP 3 /* finest mip that step 0 holds; step s holds mip STEP0_MIP - s */
/* offset of 16 words: start of each mip's part, m = 0 first; parts of later steps included */
#define ATLAS_WORD_MIP_TABLE 4
#define ATLAS_HEADER_WORDS 24
#define ATLAS_MAX_MIPS 14

/* Chart table entry, 2 words, at ATLAS_HEADER_WORDS + 2 * chart. */
#define ATLAS_CHART_SIZE 0 /* width | height << 16, texels of mip 0, 1..8192 */
/* bit 0: repeat in u, bit 1: repeat in v (else clamp); bits 8..15: this chart's own mip count */
#define ATLAS_CHART_FLAGS 1
#define ATLAS_CHART_WORDS 2
#define ATLAS_CHART_REPEAT_U 1u
#define ATLAS_CHART_REPEAT_V 2u
/* A chart of the city's dictionary: the size word is its number there, it has no mips here (mip count 0), and bits
 * 16..31 are the upper half of the float of its metres per texel of mip 0. */
#define ATLAS_CHART_SHARED 4u
/* Its blocks are BC3, 4 words each: alpha (BC4), then colour. What is filtered to less than one half is not there. */
#define ATLAS_CHART_ALPHA 8u

/* A mip's part: chart_count words with the offset of each chart's blocks (relative to the part's start; 0 for
   charts that have no such mip), then the blocks, 2 words each (4 with alpha), rows of ceil(w/4) from the bottom (v =
   0) up. Mip size: max(1, size >> m). */

#endif
