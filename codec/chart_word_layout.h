// What a surface of a tile shows, in one word of its mesh or facade layer. Shared by C++ and GLSL.
#ifndef CITYSTREAM_CODEC_CHART_WORD_LAYOUT_H
#define CITYSTREAM_CODEC_CHART_WORD_LAYOUT_H

/* With this bit one colour, r | g << 8 | b << 16, bits 24..30 zero; else the number of a chart of the tile's atlas. */
#define CHART_WORD_COLOUR 0x80000000u
#define CHART_WORD_COLOUR_MASK 0xffffffu
/* A light grey: all that is in a city without pictures. */
#define CHART_WORD_UNTEXTURED 0x80b2b2b2u

#endif
