// What lies between the receiver table and the matrix of a radiance layer in GPU memory, shared by C++ and GLSL.
// FORMAT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_RADIANCE_LAYER_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_LAYER_LAYOUT_H

/* A receiver's irradiance: halves red | green << 16, blue | lit << 16, in units of irradiance_unit (irradiance.h),
   0..1. lit: 1.0 once the light passes have run for the layer, 0 before. */
#define IRRADIANCE_WORDS 2
#define IRRADIANCE_LIT 0x3c00u /* 1.0 as a half */

/* The part of a receiver's vector sum along its normal, in units of 2^-IRRADIANCE_WEIGHT_BITS of the light's.
   2^IRRADIANCE_SUM_BITS of them are one unit of irradiance. */
#define IRRADIANCE_WEIGHT_BITS 16
#define IRRADIANCE_SUM_BITS 47
/* Light as a vector is in units of 2^LIGHT_VECTOR_SHIFT of the light's: a matrix that is not lossless may make a little
   more than all the light there is, which then does not change its sign. */
#define LIGHT_VECTOR_SHIFT 1
/* A normal's three integers times its scale are of length 2^IRRADIANCE_SCALE_BITS. */
#define IRRADIANCE_SCALE_BITS 22

#endif
