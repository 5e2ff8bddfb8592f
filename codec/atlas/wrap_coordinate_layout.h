// Bit layout of the packed chart coordinate, one 32-bit word per axis, shared by C++ and GLSL. wrap_coordinate.h
// explains it.
#ifndef CITYSTREAM_CODEC_ATLAS_WRAP_COORDINATE_LAYOUT_H
#define CITYSTREAM_CODEC_ATLAS_WRAP_COORDINATE_LAYOUT_H

/* bits 31..22: origin of the padded chart / 4, 0..1023 */
#define WRAP_ORIGIN_SHIFT 22
/* bits 21..15: size of the padded chart / 4 - 1, so that 512 can be said: 4..512 */
#define WRAP_SIZE_SHIFT 15
#define WRAP_SIZE_MASK 127u
/* bits 14..0: place in the chart, in repeats: 6 bits before the point, 9 behind it */
#define WRAP_PLACE_MASK 32767u
#define WRAP_PLACE_ONE 512
#define WRAP_GRID 4 /* origins and sizes are multiples of it */

/* Chart frame (transports 1 and 2): four floats, origin u, v and size u, v of the interior in texels of the page; a
   negative size: that axis does not repeat, its places are clamped. */

#endif
