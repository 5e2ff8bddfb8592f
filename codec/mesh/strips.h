// Triangles in the order of generalised strips (Meyer 2012, section 5.3; the notes' T1 to T4). The strip code, its
// random-access variant and the wire code of general meshes all follow this order.
//
// The stream is a sequence of triangles (v0, v1, v2), each an input triangle rotated so that it follows the one before:
//   kPrevious  across the edge (v2, v0) of the triangle before: it is (v0, v2, new)
//   kNext      across the edge (v1, v2): it is (v2, v1, new)
//   kRestart   no edge shared; the first triangle is one. It is rotated so that its successor is reached by kPrevious
//              or kNext.
// So a triangle is always entered by its edge (v0, v1) and left by one of the two others.
//
// Three traversals. Belts are the paper's: breadth-first rings of triangles around a seed, strips within a ring. Pivots
// go around the vertices in the order in which the strips met them: at every step the strip takes the neighbour with
// the oldest vertex, and after a dead end it begins anew at the oldest vertex that has triangles left. So old vertices
// are mostly taken up again one after the other, in their order. Triangles that are dead ends are left for later where
// the two rims of the front are far apart in the numbering: a restart from the front would have to refer to both rims.
// Newest pivots begin anew at the newest vertex instead, which keeps to one place: for models whose faces are slivers
// between many small openings.
//
// Any list of triangles will do: an edge of three or more faces, neighbours that are turned against each other,
// repeated triangles and triangles with equal corners only cost restarts. Orientation is kept. The order depends on the
// input alone. O(n log n) time for n triangles, about 70 bytes a triangle of working memory.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::mesh {

enum class StripStep : uint8_t { kPrevious = 0, kNext = 1, kRestart = 2 };

struct StripTriangle {
    uint32_t triangle;  ///< index in the input
    uint8_t rotation;   ///< corner k of the stream is corner (rotation + k) % 3 of the input
    StripStep step;
    bool operator==(const StripTriangle&) const = default;
};

struct StripOrder {
    std::vector<StripTriangle> triangles;  ///< every input triangle once
};

/// Pivots take fewer bits on all but the most regular grids, and never many more.
enum class StripTraversal : uint8_t { kPivots, kNewestPivots, kBelts };

/// Preconditions: every corner < vertex_count; fewer than 2^30 triangles.
StripOrder order_strips(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count,
                        StripTraversal traversal = StripTraversal::kPivots);

/// The corners of one triangle of the stream.
inline std::array<uint32_t, 3> strip_corners(std::span<const std::array<uint32_t, 3>> triangles,
                                             const StripTriangle& place) {
    const auto& corners = triangles[place.triangle];
    const size_t r = place.rotation;
    return {corners[r], corners[(r + 1) % 3], corners[(r + 2) % 3]};
}

/// The vertices by first use in the stream, those that no triangle uses at the end in input order: element k is the
/// input index of the vertex that is numbered k from now on.
std::vector<uint32_t> order_of_first_use(std::span<const std::array<uint32_t, 3>> triangles, const StripOrder& order,
                                         uint32_t vertex_count);

/// The new number of each input vertex.
std::vector<uint32_t> inverse_order(std::span<const uint32_t> order);

}  // namespace citystream::codec::mesh
