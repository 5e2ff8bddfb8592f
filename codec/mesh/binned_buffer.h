// Vertices sorted into bins by their least bit level (Meyer 2012, section 3.5.4, P7), and the whole way from points to
// buffers. The buffer itself is that of adaptive_precision.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/adaptive_precision.h"
#include "codec/mesh/precision.h"

namespace citystream::codec::mesh {

/// Order of vertices by least level, equal ones as they were. order[i]: which vertex becomes vertex i; all indices and
/// other attributes have to follow.
std::vector<uint32_t> order_by_level(std::span<const uint32_t> least_levels);

/// Positions as they are packed: plane by plane or at once.
struct PositionWords {
    PrecisionGrid grid;
    PrecisionShape shape;
    std::vector<uint32_t> order;  ///< as order_by_level
    std::vector<uint32_t> words;  ///< in the new order, three a vertex
};

/// Adaptive precision: one bin, order unchanged. Least level: full_bits - common_dropped.
PositionWords adaptive_positions(std::span<const GridPoint> points, uint32_t common_dropped,
                                 Reconstruction reading = Reconstruction::kThirds);

/// Constrained precision: vertex v never drops more than most_dropped[v] bits (constrained_precision.h; more than
/// common_dropped means common_dropped).
PositionWords constrained_positions(std::span<const GridPoint> points, std::span<const uint32_t> most_dropped,
                                    uint32_t common_dropped, Reconstruction reading = Reconstruction::kThirds);

/// The buffer level at which `dropped` bits are missing.
inline uint32_t level_of(const PrecisionGrid& grid, uint32_t dropped) {
    return grid.full_bits() - dropped;
}

/// A vertex as the vertex shader shows it (P9): fetched, and cut to the bits that the rule grants at its own distance,
/// never below its bin's least level (P4; in a buffer that has fewer bits than the rule wants, to all it has).
/// `from_camera` as in dropped_in_box.
GridPoint shown_position(const PrecisionView& buffer, const PrecisionGrid& grid, uint32_t vertex, const DropRule& rule,
                         const std::array<int32_t, 3>& from_camera);

}  // namespace citystream::codec::mesh
