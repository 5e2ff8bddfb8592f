// Distances between surfaces, sampled both ways: what makes a simplified object's stated error a measurement.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

using Point3 = std::array<double, 3>;  ///< grid units, about an origin of the caller's choice
using Triangle3 = std::array<Point3, 3>;

/// Triangles of an object (its facades as two each) about `origin`.
std::vector<Triangle3> surface_of(const quadtree::BuildObject& object, const GridPoint& origin);

double squared_distance(const Point3& p, const Triangle3& triangle);

/// Greatest distance of the corners, edge middles and centres of `from` to the surface `to`; stops early beyond `limit`
/// (returns something greater). O(|from| * |to|).
double one_sided_distance(std::span<const Triangle3> from, std::span<const Triangle3> to, double limit);

/// The greater of both directions.
double surface_distance(std::span<const Triangle3> a, std::span<const Triangle3> b, double limit);

}  // namespace citystream::tiles::layers
