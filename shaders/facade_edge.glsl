// Where facades meet, at a building's corners.
#ifndef CITYSTREAM_FACADE_EDGE_GLSL
#define CITYSTREAM_FACADE_EDGE_GLSL

// Texels (1 mm): the facade pass reaches that far beyond a map's volume, so that rounding leaves no gap between facades that meet.
const float kEdgeMargin = 0.1;
// Of two surfaces in one plane, the one that is seen through a facade's edge, inside the neighbouring facade's wall, yields: factor of its depth.
const float kEdgeYields = 0.999;

#endif
