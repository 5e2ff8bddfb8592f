// Octahedral unit vectors folded in integers (Meyer 2012, section 4.6 OP and 4.7.2; notes N13 with the errata of the
// inverse): one chart, so that every bit of an even budget is used, and of all parameterisations the one nearest to
// the optimum (1.14 bits above Fejes Toth's bound).
//
// A code of n bits a parameter, 2..32, holds u in bits 0..n-1 and v in bits n..2n-1, both biased by the lattice's side
// S = 2^(n-1) - 1. The lattice has 2S + 1 = 2^n - 1 points a parameter, an odd number (the thesis has 2^n): zero is one
// of them, so that the six axis directions - walls that follow the axes, flat roofs - decode exactly. The value 2^n - 1
// is not written; it reads as 2S.
//
// The largest error is sqrt(2) * step, step = 2 / 2S: 0.64 degrees for n = 8, 0.0025 for 16, 1.7e-7 radians for 24.
// Encoding takes doubles and only their exact operations and roots: the same code everywhere. Decoding is in integers,
// the same on CPU and GPU (shaders/octahedral.glsl). Both are O(1).
#pragma once

#include <array>
#include <cstdint>

#include "codec/mesh/direction.h"

namespace citystream::codec::mesh {

constexpr uint32_t kLeastOctahedralBits = 2, kMostOctahedralBits = 32;  ///< a parameter

/// S. `bits` is 2..32 here and below.
constexpr int32_t octahedral_side(uint32_t bits) {
    return static_cast<int32_t>((uint32_t{1} << (bits - 1)) - 1);
}

/// Packs a vector of any length by range quantisation: the nearest of the four enclosing lattice points. Zero and
/// non-finite vectors give +z.
uint64_t pack_octahedral(const Direction& normal, uint32_t bits);

/// Decodes to (x, y, z) on the octahedron |x| + |y| + |z| = S, not normalised. z = S - |u| - |v|; where z < 0:
/// x = sg(u) (S - |v|), y = sg(v) (S - |u|) with sg(0) = +1. Bits above 2n are not looked at: any code is a direction.
std::array<int32_t, 3> unfold_octahedral(uint64_t packed, uint32_t bits);

/// unfold, then normalised.
Direction unpack_octahedral(uint64_t packed, uint32_t bits);

/// The same in floats, as shaders do it. Up to 25 bits the integers are floats, and the error is that of the code and
/// of rounding a unit vector to floats (5.1e-8 radians); from there on it stays near 1e-7.
std::array<float, 3> unpack_octahedral_float(uint64_t packed, uint32_t bits);

/// The same for codes of 8 + 8 bits, which mesh layers hold.
uint32_t pack_octahedral16(const float normal[3]);
void unfold_octahedral16(uint32_t packed, int32_t out[3]);
void unpack_octahedral16(uint32_t packed, float out[3]);

}  // namespace citystream::codec::mesh
