// How a footprint was cut into triangles: rings whose points are the only corners, coded triangle by triangle.
//
// The area between the rings is one loop of points at first (the outer ring). The triangle on the loop's first edge has
// its third corner either on the loop, which it cuts in two, or on a hole that has not been met, which joins the loop.
// So a triangulation is a sequence of such choices. Most are what sweep_triangles guesses; the others are coded as
// ranks among the possible corners, best first: the corner that sees the edge under the largest angle (as in a Delaunay
// triangulation), in exact integers.
//
// Rings that can be told so are discs with holes, in the sense of how triangles hang together: positions may coincide
// or cross. is_ring_triangulation says whether triangles are of this kind.
//
// Complexity: O(n) a choice for n points, so O(n^2) for a prism; prisms with more than kMostRingPoints points are not
// taken.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

/// So that hostile bytes cannot ask for hours.
constexpr uint32_t kMostRingPoints = 1u << 12;

struct RingArea;

class RingTriangleModel {
  public:
    /// Codes the triangles over `rings` (counter-clockwise, as a prism's top); a decoder fills them. They need to be a
    /// ring triangulation. A decoder's triangles are one of whatever is read; `rings` have at least 3 points each.
    template <typename Coder>
    void code(Coder& coder, std::span<const Ring> rings, std::vector<std::array<uint32_t, 3>>& triangles);

  private:
    static constexpr uint32_t kSizes = 8, kRanks = 8, kDoubts = 8;
    struct Choice {
        size_t hole, place;  ///< `place` on the loop, or on a hole that has not been met
    };
    template <typename Coder>
    Choice code_unguessed(Coder& coder, const RingArea& area, std::span<const uint32_t> loop, Choice wanted);
    template <typename Coder>
    size_t code_place(Coder& coder, std::span<const std::array<int32_t, 2>> points, std::span<const uint32_t> loop,
                      size_t place);
    bits::BitModel as_guessed_[2][kDoubts];  ///< by whether the last one was; for quadrilaterals by how close it is
    bits::BitModel hole_[2];                 ///< by whether the loop is a triangle
    bits::BitModel rank_[kSizes][kRanks];    ///< a worse corner; by the loop's size and the rank
};

/// Whether triangles (indices below the rings' number of points) cut the rings as the code needs it.
bool is_ring_triangulation(std::span<const Ring> rings, std::span<const std::array<uint32_t, 3>> triangles);

}  // namespace citystream::codec::mesh
