// Walks the tiled form of a facade map: from run cell to run cell, as the quotient is walked.
#ifndef CITYSTREAM_FACADE_STEP_TILED_GLSL
#define CITYSTREAM_FACADE_STEP_TILED_GLSL

#include "shaders/facade_step_quotient.glsl"

FacadeHit step_tiled(FacadeMap map, FacadeRay ray, FacadeSpan span) { return step_quotient(map, ray, span); }

#endif
