// Prisms as records of one size, so that a vertex shader finds any of them by multiplying: a loop of m points, base and
// top, m - 2 triangles of the top.
//
// A prism with holes becomes one loop by the way: every ring ends at its first point again, and where the loop goes
// from ring to ring there is no wall. A wall that is not there has its base at the top, so that it has no area. A
// prism with fewer points than its record repeats the last one. So every prism has a record, and few sizes do.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/mesh/mesh_content.h"

namespace citystream::codec::mesh {

struct PrismRecord {
    std::vector<std::array<int32_t, 2>> points;
    int32_t base = 0, top = 0;
    std::vector<int32_t> wall_bases;  ///< of the wall from each point to the next
    bool has_wall_bases = false;      ///< some differ from `base`
    /// Counter-clockwise from above; points.size() - 2, those with equal corners are put in. As few orders as possible:
    /// each begins with its least corner, and they rise.
    std::vector<std::array<uint32_t, 3>> top_triangles;
};

/// A record of at least `points` points. `dropped`: what the first step leaves out. A base that is the prism's in the
/// bits above is the prism's.
PrismRecord prism_record(const Prism& prism, uint32_t dropped, size_t points = 0);

/// Prisms that are drawn together.
struct PrismGroup {
    uint32_t points = 0;
    bool wall_bases = false, floors = false;
    std::vector<uint32_t> prisms;  ///< indices in the content, ascending

    /// Position words of a prism.
    uint64_t record_words() const { return 2 + uint64_t{wall_bases ? 3u : 2u} * points; }
    uint64_t triangles() const { return 2 * uint64_t{points} + (points - 2) * (floors ? 2u : 1u); }
};

/// By number of points, sizes of few prisms joined to greater ones where that takes less than another range. `level`:
/// bits of a position word. Depends on no bit of a position below the first step's.
std::vector<PrismGroup> group_prisms(const MeshContent& content, uint32_t level);

}  // namespace citystream::codec::mesh
