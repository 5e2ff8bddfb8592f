// Directions in space as three doubles of any length: how they are brought to a length that can be reckoned with, and
// the angle between two of them (Meyer 2012, section 4.2.1; notes N1).
#pragma once

#include <array>

namespace citystream::codec::mesh {

using Direction = std::array<double, 3>;

/// Divides by the largest component, so that squares neither overflow nor vanish, whatever the length; all components
/// come to lie in -1..1. Zero and non-finite vectors have no direction: +z stands for them.
/// Real is float or double.
template <typename Real>
std::array<Real, 3> scaled_direction(const std::array<Real, 3>& vector);

/// Euclidean length 1, of any vector; +z where there is no direction.
Direction unit_direction(const Direction& vector);

/// Radians, 0..pi, of vectors of any length; zero and non-finite ones are +z. By the arc tangent of cross and dot
/// product: exact to a few 10^-16 of itself down to angles of 10^-16, where the arc cosine of the dot product is lost
/// below 10^-8.
double angle_between(const Direction& a, const Direction& b);

}  // namespace citystream::codec::mesh
