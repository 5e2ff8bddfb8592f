// Unit vectors with z >= 0, such as the normals of a tangent-space normal map: one chart of the warped octahedron
// (Meyer 2012, sections 4.6 WOP and 4.10; notes N14, N17), folded in integers. The chart is the whole square and meets
// itself nowhere, so that texels of it may be filtered (an octahedron's may not, across its folds), and no bit is
// spent on a half of the sphere that does not occur.
//
// A code of n bits a parameter, 2..32, is laid out as in octahedral.h: u | v << n, biased by S = 2^(n-1) - 1, an odd
// number of lattice points, so that the flat normal +z and the directions halfway between the axes (z = 0, x = +-y)
// decode exactly. The axes +-x, +-y lie at the square's corners and are exact, too. The largest error is
// sqrt(6)/2 * step, step = 2 / 2S: 0.55 degrees for n = 8. Both calls are O(1).
#pragma once

#include <array>
#include <cstdint>

#include "codec/mesh/direction.h"

namespace citystream::codec::mesh {

/// Packs a vector of any length by range quantisation. A vector below the plane z = 0 is moved up onto it; zero,
/// non-finite vectors and -z give +z.
uint64_t pack_hemisphere(const Direction& normal, uint32_t bits);

/// Decodes to (u + v, v - u, 2 (S - max(|u|, |v|))), on the octahedron |x| + |y| + |z| = 2S, not normalised. Any code
/// is a direction with z >= 0.
std::array<int64_t, 3> unfold_hemisphere(uint64_t packed, uint32_t bits);

/// unfold, then normalised.
Direction unpack_hemisphere(uint64_t packed, uint32_t bits);

}  // namespace citystream::codec::mesh
