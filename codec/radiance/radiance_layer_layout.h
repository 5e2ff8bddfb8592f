// What lies between the receiver table and the matrix of a radiance layer in GPU memory, shared by C++ and GLSL.
// FORMAT.md beside this file explains it.
#ifndef CITYSTREAM_CODEC_RADIANCE_LAYER_LAYOUT_H
#define CITYSTREAM_CODEC_RADIANCE_LAYER_LAYOUT_H

/* A receiver's irradiance: halves red | green << 16, blue | lit << 16, in units of irradiance_unit (irradiance.h),
   0..1. lit: 1.0 once the light passes have run for the layer, 0 before. */
#define IRRADIANCE_WORDS 2
#define IRRADIANCE_LIT 0x3c00u /* 1.0 as a half */

/* Weights of local directions are cosines in units of 2^-IRRADIANCE_WEIGHT_BITS. A receiver's sum of weights times rows
   is below 2^IRRADIANCE_SUM_BITS, which is one unit of irradiance. */
#define IRRADIANCE_WEIGHT_BITS 16
#define IRRADIANCE_SUM_BITS 47

#endif
