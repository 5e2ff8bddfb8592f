// The difference of two octahedral codes, such that directions close to each other differ by little wherever they lie,
// across the folds of the square, too: what is left of a normal once it is predicted.
//
// Where the prediction lies in the lower half, both directions are mirrored in the plane z = 0 first, so that the
// prediction lies in the middle of the square, round which it is one piece; differences of the places there wrap round
// the square's 2S + 1 values. So every direction has one residual for each prediction, and every pair -S..S is the
// residual of a valid code: bytes that nobody vouches for decode to some direction. All calls are O(1) and in integers.
#pragma once

#include <array>
#include <cstdint>

namespace citystream::codec::mesh {

/// The one code (octahedral.h) of a direction that has several: directions with z < 0 in the planes x = 0 and y = 0 lie
/// at the square's rim twice, -z at its four corners. pack_octahedral gives any of them.
uint64_t canonical_octahedral(uint64_t packed, uint32_t bits);

/// The canonical code of unfold_octahedral's vector.
uint64_t fold_octahedral(const std::array<int32_t, 3>& direction, uint32_t bits);

/// u and v, each -S..S, of `actual` against `predicted` (any codes).
std::array<int32_t, 2> octahedral_residual(uint64_t actual, uint64_t predicted, uint32_t bits);

/// Its inverse: the canonical code of `actual`. Residuals outside -S..S are wrapped.
uint64_t octahedral_of_residual(const std::array<int32_t, 2>& residual, uint64_t predicted, uint32_t bits);

}  // namespace citystream::codec::mesh
