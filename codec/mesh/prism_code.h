// Prisms as range coded bytes: what travels of most of a city.
//
// Order: how many there are of distinct heights, and these; the lattices that the points are on (hidden_lattice.h);
// then the prisms along a tree in which each hangs on one that is near (prism_order.h). A prism is its footprint in
// lattice numbers (footprint_code.h), what its points are off the lattice, base and height, floor, walls, and how top
// and floor are cut into triangles (ring_triangles.h). Lossless, but for the order of prisms and where rings begin.
//
// Prisms can also travel in planes: first with the lowest bits of all coordinates dropped, later those bits
// (prism_planes.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/lattice_code.h"
#include "codec/mesh/prisms.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct PrismLimits {
    /// Most points of all rings: what a decoder makes room for. To be set by what is known of the prisms: few bytes can
    /// say many points.
    uint32_t points = 1u << 22;
};

/// How prisms were told.
struct PrismTree {
    static constexpr uint32_t kRoot = ~uint32_t{0};
    std::vector<uint32_t> parent;  ///< of each prism in the order told: the earlier one it hangs on, or kRoot
    std::vector<uint32_t> source;  ///< which of the given prisms each was; a decoder does not fill it
    /// Of the points with all bits, in the order told; a decoder does not fill them.
    std::vector<HiddenLattice> lattices;
};

/// Writes prisms as split_prisms gives them, each coordinate >> dropped (0..29), and returns them as the decoder will
/// have them (with all their bits). `known`: of the last call (lattice_code.h). O(n log n) for n points but for the
/// triangles (ring_triangles.h).
std::vector<Prism> encode_prisms(bits::RangeEncoder& encoder, std::span<const Prism> prisms, uint32_t dropped = 0,
                                 PrismTree* tree = nullptr, KnownLattices* known = nullptr);

/// The prisms again. For untrusted bytes: an error, or prisms of which rings have at least 3 points below 2^30 in
/// magnitude, walls and triangles are in range, and base <= top. Call decoder.finish() after the last number that the
/// bytes hold. Memory is in proportion to the points, and these are within the limits.
Result<std::vector<Prism>> decode_prisms(bits::RangeDecoder& decoder, const PrismLimits& limits = {},
                                         PrismTree* tree = nullptr);

/// The same with all points and triangles of walls, tops and floors counted against what a mesh may have; what they
/// take is taken off.
Result<std::vector<Prism>> decode_prisms_within(bits::RangeDecoder& decoder, uint32_t& points, uint32_t& triangles,
                                                PrismTree* tree = nullptr);

}  // namespace citystream::codec::mesh
