// Word layout of a tile's transfer matrix in GPU memory, shared by C++ and GLSL. FORMAT.md beside this file explains
// it.
#ifndef CITYSTREAM_CODEC_RADIANCE_RESIDENT_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_RESIDENT_LAYOUT_H

#define RADIANCE_MAGIC 0x31525343u /* "CSR1" */

/* Header words. Offsets are in words from the start. Parts lie in the order of their offsets without gaps. */
#define RADIANCE_WORD_MAGIC 0
#define RADIANCE_WORD_RECEIVERS 1
#define RADIANCE_WORD_LOCALS 2   /* local directions of a receiver */
#define RADIANCE_WORD_COLUMNS 3  /* source texels */
#define RADIANCE_WORD_ROWS 4     /* rows of the matrix, each once */
#define RADIANCE_WORD_CLUSTERS 5 /* biclusters */
#define RADIANCE_WORD_TERMS 6    /* columns of all clusters */
#define RADIANCE_WORD_LINKS 7    /* rows of all clusters */
/* Starts: where the terms of each cluster and the links of each row begin, and where the last ones end. */
#define RADIANCE_WORD_TERM_STARTS 8
#define RADIANCE_WORD_LINK_STARTS 9
#define RADIANCE_WORD_TERM_FIELDS 10 /* column | (quarters - least quarters) << bits of a column */
#define RADIANCE_WORD_LINK_FIELDS 11 /* a cluster; those of a row rise */
#define RADIANCE_WORD_ROW_FIELDS 12  /* of receiver * locals + local: its row */
/* bits of a column | of a quarter << 8 | of a link << 16 | of a row << 24 */
#define RADIANCE_WORD_BITS 13
/* bits of a term start | of a link start << 8 | (least quarters + 128) << 16 */
#define RADIANCE_WORD_START_BITS 14
/* word 15: 0 */
#define RADIANCE_HEADER_WORDS 16

/* Starts are a word for each RADIANCE_START_GROUP of them, then for each a field to be added to its group's word. */
#define RADIANCE_START_GROUP 16u

#endif
