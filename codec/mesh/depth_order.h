// Keeps objects that lie close to each other from running into each other where bits are dropped (Meyer 2012, section
// 3.5.2, P6), with a tree of boxes instead of all pairs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/precision.h"

namespace citystream::codec::mesh {

/// Most dropped bits of each vertex, 0..grid.common_dropped, the same for all vertices at one position, so that no two
/// triangles of different objects meet that do not meet at full precision, at any number of dropped bits that *all*
/// vertices are cut to (each to the lesser of that and its own). `object` names the object of each triangle; triangles
/// of one object are left alone.
///
/// From full precision on, all vertices that are still free drop one bit more; those of triangles that then meet go
/// back and stay, until no new pair meets. Exact and deterministic. Each round costs what the tree needs to list the
/// pairs of boxes that meet.
std::vector<uint32_t> depth_order_dropped(std::span<const GridPoint> points,
                                          std::span<const std::array<uint32_t, 3>> triangles,
                                          std::span<const uint32_t> object, const PrecisionGrid& grid);

/// Pairs of triangles of different objects that meet where vertex v drops dropped[v] bits and did not before.
std::vector<std::array<uint32_t, 2>> new_meetings(std::span<const GridPoint> points,
                                                  std::span<const std::array<uint32_t, 3>> triangles,
                                                  std::span<const uint32_t> object, const PrecisionGrid& grid,
                                                  std::span<const uint32_t> dropped);

}  // namespace citystream::codec::mesh
