// Word layout of a precision buffer and the constants of the precision rule, shared by C++ and GLSL.
// adaptive_precision.h explains the buffer, precision.h the rule.
#ifndef CITYSTREAM_CODEC_PRECISION_LAYOUT_H
#define CITYSTREAM_CODEC_PRECISION_LAYOUT_H

#define PRECISION_MAGIC 0x31505343u /* "CSP1" */

/* Header words. */
#define PRECISION_WORD_MAGIC 0
#define PRECISION_WORD_VERTICES 1
/* bins | components << 8 | full bits << 16 | level << 24 */
#define PRECISION_WORD_SHAPE 2
/* leading zero bits of each component's words, 8 bits a component */
#define PRECISION_WORD_LEADING 3
#define PRECISION_WORD_BINS 4

/* Of a bin: first vertex | least level << 27; first bit of the payload. The payload begins behind the last bin. */
#define PRECISION_BIN_WORDS 2
#define PRECISION_BIN_LEVEL_SHIFT 27
#define PRECISION_MOST_BINS 32
#define PRECISION_MOST_COMPONENTS 4
#define PRECISION_MOST_BITS 31

/* How a coordinate is read whose low bits are not there (precision.h). */
#define PRECISION_READ_LOW 0u
#define PRECISION_READ_MIDDLE 1u
#define PRECISION_READ_THIRDS 2u
#define PRECISION_THIRDS_PATTERN 0x55555555u

/* Distances are bounded from below by the largest of five weighted sums of the sorted gaps along the axes: weights in
   1/256, each a vector of at most unit length. Gaps are taken in units of 2^8, which makes the sums grid units. */
#define PRECISION_GAP_SHIFT 8
#define PRECISION_WEIGHT_AXIS 256u
#define PRECISION_WEIGHT_EDGE 181u
#define PRECISION_WEIGHT_CORNER 147u
#define PRECISION_WEIGHT_NEAR_AXIS_1 236u
#define PRECISION_WEIGHT_NEAR_AXIS_2 98u
#define PRECISION_WEIGHT_NEAR_CORNER_1 208u
#define PRECISION_WEIGHT_NEAR_CORNER_2 105u

#endif
