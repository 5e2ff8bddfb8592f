// Octahedral unit vectors, 8 + 8 bits, folded in integers (Meyer 2012, section 4.3 OP; notes: range quantisation,
// errata of the inverse). The lattice has 255 x 255 points (odd, so that zero is a point): u and v are -127..127,
// stored biased by 127 (byte 0..254; 255 reads as 254).
#pragma once

#include <cstdint>

namespace citystream::codec::mesh {

/// Packs a vector (any length) to (u + 127) | (v + 127) << 8 by range quantisation: the best of the four enclosing
/// lattice points. The six axis directions decode exactly; no direction is off by more than 0.64 degrees. Zero and
/// non-finite vectors give +z.
uint32_t pack_octahedral16(const float normal[3]);

/// Decodes to integers (x, y, z) on the octahedron |x| + |y| + |z| = 127, not normalised: exact, the same on CPU and
/// GPU. z = 127 - |u| - |v|; where z < 0: x = sg(u) (127 - |v|), y = sg(v) (127 - |u|) with sg(0) = +1. Only the low 16
/// bits are looked at.
void unfold_octahedral16(uint32_t packed, int32_t out[3]);

/// unfold, then normalised in float.
void unpack_octahedral16(uint32_t packed, float out[3]);

}  // namespace citystream::codec::mesh
