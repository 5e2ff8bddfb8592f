// Words of a tile's local light in GPU memory, shared by C++ and GLSL. local_light.h explains them.
#ifndef CITYSTREAM_CODEC_RADIANCE_LOCAL_LIGHT_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_LOCAL_LIGHT_LAYOUT_H

/* Local directions, 8 x 8: layers with others have no local light. A word each, receiver by receiver. */
#define LOCAL_LIGHT_DIRECTIONS 64

/* A word: red | green << 9 | blue << 18 | exponent << 27, a channel being its 9 bits times 2^exponent, in units of
   2^-LOCAL_LIGHT_UNIT_BITS of irradiance_unit (irradiance.h). */
#define LOCAL_LIGHT_BITS 9
#define LOCAL_LIGHT_UNIT_BITS 31

#endif
