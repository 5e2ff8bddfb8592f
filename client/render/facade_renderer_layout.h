// The facade renderers of facade_renderer.h as numbers, shared by C++ and GLSL: shaders are compiled once for each,
// with FACADE_RENDERER as one of them. And how many rays a pixel they cast.
#ifndef CITYSTREAM_CLIENT_FACADE_RENDERER_LAYOUT_H
#define CITYSTREAM_CLIENT_FACADE_RENDERER_LAYOUT_H

#define FACADE_RENDERER_PATCH 0
#define FACADE_RENDERER_MAX_MIP 1
#define FACADE_RENDERER_RM 2
#define FACADE_RENDERER_FDM 3
#define FACADE_RENDERER_CRM 4
#define FACADE_RENDERER_BCRM 5
#define FACADE_RENDERER_CFDM 6
#define FACADE_RENDERER_BCFDM 7
#define FACADE_RENDERER_QUOTIENT 8
#define FACADE_RENDERER_COUNT 9

/* Rays of a pixel that covers more than the finest parts of its facade (shaders/facade_samples.glsl). */
#define FACADE_SAMPLES 5
#define FACADE_MOST_SAMPLES 13

#endif
