// Footprint outlines: the border of an object's roofs seen from above, made simpler, and cut into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Grid units, relative to a point of the caller's choice.
using OutlinePoint = std::array<int64_t, 2>;
using Outline = std::vector<OutlinePoint>;

/// Loops that bound the upward triangles seen from above: outer ones counter-clockwise, holes clockwise. Loops that do
/// not close are left out.
std::vector<Outline> roof_outlines(const quadtree::BuildObject& object, const GridPoint& origin);

/// Twice the signed area, counter-clockwise positive.
double doubled_area(const Outline& outline);

/// Removes, least first, corners nearer than `tolerance` to the line of their neighbours; at least 3 remain.
void simplify_outline(Outline& outline, double tolerance);

/// Ear clipping of a simple counter-clockwise polygon: corner indices, 3 a triangle; empty when it is not simple.
std::vector<uint32_t> triangulate_outline(const Outline& outline);

/// The smallest rectangle around points, sides along one of the directions given (at least one). Counter-clockwise.
Outline oriented_box(const std::vector<OutlinePoint>& points, const std::vector<OutlinePoint>& directions);

}  // namespace citystream::tiles::layers
