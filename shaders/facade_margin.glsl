// How far the facade pass reaches beyond a map's volume.
#ifndef CITYSTREAM_FACADE_MARGIN_GLSL
#define CITYSTREAM_FACADE_MARGIN_GLSL

// Texels (1 mm): facades that meet at a building's corner overlap by it, so that rounding leaves no gap between them.
const float kEdgeMargin = 0.1;

#endif
