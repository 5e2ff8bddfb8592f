// How many low bits each point may drop (constrained precision), on the wire, and the steps of points that differ in
// this: a point has in step s all but the lowest min(dropped[s], most_dropped) bits.
//
// One template for writer and reader (range_coder.h).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/point_refinement.h"

namespace citystream::codec::mesh {

/// One number 0..kMeshGridBits a point, in the order of the walk: as at the points that it was met from, or not.
template <typename Coder>
void code_most_dropped(Coder& coder, std::span<const Origin> origins, std::span<uint8_t> most_dropped) {
    bits::MixedBits equal({17 * 17, 17 * 3, 9}, 2);
    std::vector<bits::BitTree> other(kMeshGridBits + 1, bits::BitTree(kMeshGridBits + 1));
    uint32_t last = 0;
    for (size_t i = 0; i < origins.size(); ++i) {
        const GateVertices& from = origins[i].gate;
        const uint32_t a = i > 0 ? most_dropped[from.a] : 0, b = i > 0 ? most_dropped[from.b] : 0,
                       c = i > 0 ? most_dropped[from.c] : 0;
        const uint32_t alike = (a == b ? 1u : 0u) + (a == c ? 2u : 0u);
        equal.set_contexts({a * 17 + b, a * 3 + last, alike * 2 + (last != 0 ? 1u : 0u)});
        uint32_t value = most_dropped[i];
        last = 0;
        if (equal.code(coder, 0, value == a ? 1 : 0) != 0) {
            value = a;
        } else if (b != a && equal.code(coder, 1, value == b ? 1 : 0) != 0) {
            value = b;
            last = 1;
        } else {
            value = other[a].code(coder, value);
            last = 2;
        }
        most_dropped[i] = static_cast<uint8_t>(value);
    }
}

/// Points of a walk, and how much of them is known. Grid units from the walk's lowest point.
struct PointLevels {
    std::vector<GridPoint> points;      ///< bits that are not known are 0
    std::vector<uint8_t> most_dropped;  ///< empty: no limits
    uint32_t least_most = 0;            ///< of most_dropped

    uint32_t dropped_of(size_t point, uint32_t dropped) const {
        return most_dropped.empty() ? dropped : std::min<uint32_t>(dropped, most_dropped[point]);
    }
    /// To be called when most_dropped is filled.
    void find_least() {
        least_most = most_dropped.empty() ? 0 : *std::min_element(most_dropped.begin(), most_dropped.end());
    }
    /// With the walk's lowest point, of which `dropped` bits are left out, added.
    std::vector<GridPoint> absolute_points(const GridPoint& low, uint32_t dropped) const {
        std::vector<GridPoint> result = points;
        for (GridPoint& point : result) {
            for (size_t k = 0; k < 3; ++k) point[k] = static_cast<int32_t>(point[k] + (int64_t{low[k]} << dropped));
        }
        return result;
    }
    /// In step 0: what points have beside the walk's bits, which lack the lowest `dropped`.
    template <typename Coder>
    void code_first(Coder& coder, std::span<const Origin> origins, uint32_t dropped,
                    std::span<const GridPoint> whole = {}) {
        code_bits(coder, origins, dropped, dropped, true, whole);
    }
    /// Takes all points from where a step leaves them that drops `before` bits to where one does that drops fewer.
    template <typename Coder>
    void code_step(Coder& coder, std::span<const Origin> origins, uint32_t before, uint32_t after,
                   std::span<const GridPoint> whole = {}) {
        code_bits(coder, origins, before, after, false, whole);
    }

  private:
    template <typename Coder>
    void code_bits(Coder& coder, std::span<const Origin> origins, uint32_t before, uint32_t after, bool alike,
                   std::span<const GridPoint> whole);
};

template <typename Coder>
void PointLevels::code_bits(Coder& coder, std::span<const Origin> origins, uint32_t before, uint32_t after, bool alike,
                            std::span<const GridPoint> whole) {
    const uint32_t scale = most_dropped.empty() ? after : std::min(after, least_most);
    if (scale >= before) return;
    for (GridPoint& point : points) {
        for (int32_t& coordinate : point) coordinate >>= scale;
    }
    PointRefinement refinement(before - scale);
    for (uint32_t i = 0; i < points.size(); ++i) {
        GridPoint wanted{};
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) break;
        } else {
            for (size_t k = 0; k < 3; ++k) wanted[k] = whole[i][k] >> scale;
        }
        const uint32_t lacking = alike ? before : dropped_of(i, before);
        refinement.code_part(coder, points, i, origins[i], {lacking - scale, dropped_of(i, after) - scale}, wanted);
    }
    make_room(points, scale);
}

}  // namespace citystream::codec::mesh
