// Which triangles meet in an edge, in any list of triangles.
//
// Half-edge 3 t + c goes from corner c of triangle t to the next corner.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::mesh {

inline constexpr uint32_t kNoEdge = ~uint32_t{0};

constexpr uint32_t next_edge(uint32_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}
constexpr uint32_t previous_edge(uint32_t edge) {
    return edge % 3 == 0 ? edge + 2 : edge - 1;
}

/// For every half-edge one that runs against it in another triangle, kNoEdge on a border; b is paired with a where a is
/// with b. Where several run the same way between two vertices, the n-th is paired with the n-th against it: parts that
/// touch in an edge come one after the other more often than not. Triangles with two equal corners have no neighbours.
/// Preconditions: every corner < vertex_count, fewer than 2^30 triangles. O(n log n), about 40 bytes a triangle.
std::vector<uint32_t> pair_edges(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count);

/// The corners (numbered like half-edges) at each vertex, in order: those of vertex v are items[begin[v]] up to
/// items[begin[v + 1]].
struct VertexCorners {
    std::vector<uint32_t> begin, items;
    std::span<const uint32_t> of(uint32_t vertex) const {
        return std::span(items).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
    }
};
VertexCorners corners_around(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count);

}  // namespace citystream::codec::mesh
