// Where the corners of polygons lie in charts that are packed into pages: places that the packed coordinate
// (codec/atlas/wrap_coordinate.h) holds, so that every transport shows the same. The builder moves them, as a renderer
// that rounded on its own would show other pictures by one transport than by the others.
//
// Source: "Space-Optimized Texture Atlases" 8.1.1 to 8.1.4.
#pragma once

#include <array>
#include <span>

#include "codec/atlas/atlas_layer.h"

namespace citystream::tiles::layers {

/// Along u and v, in repeats of the chart.
using ChartPlaceOfCorner = std::array<double, 2>;

/// Moves the corners of one polygon to multiples of 1/512 repeat, by at most half of that; the same place moves alike
/// in every polygon. An axis that repeats begins in [0, 1) where it was not within [0, 64): whole repeats less, the
/// same for all corners. On one that does not, what lies up to half a texel below 0, where all shows the first texel,
/// moves to 0. What still cannot be packed stays for other transports: 64 repeats or more in one polygon, and
/// places farther below 0 on an axis that does not repeat.
void fit_page_places(std::span<ChartPlaceOfCorner> corners, const codec::atlas::ChartImage& chart);

}  // namespace citystream::tiles::layers
