// The pieces that prisms are put together from: welded points, walls, and level parts with their border rings.
// Only prisms.cpp needs them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

using Edge = std::pair<uint32_t, uint32_t>;  ///< from point to point

/// Points numbered by position, so that equal positions are one point; numbers run in order of position.
struct WeldedMesh {
    static constexpr uint32_t kNone = ~uint32_t{0};
    std::vector<GridPoint> points;
    std::vector<std::array<uint32_t, 3>> triangles;

    explicit WeldedMesh(const GridMesh& mesh);
    int32_t height(uint32_t point) const { return points[point][2]; }
    bool same_place(uint32_t a, uint32_t b) const {
        return points[a][0] == points[b][0] && points[a][1] == points[b][1];
    }
    /// The point above or below `point` at a height, or kNone.
    uint32_t at_height(uint32_t point, int32_t height) const;
};

/// Numbers of things found by the edge that they stand on; equal edges in order of their things.
class EdgeIndex {
  public:
    using Entry = std::pair<Edge, uint32_t>;
    void add(Edge edge, uint32_t thing) { entries_.emplace_back(edge, thing); }
    /// Between the last add and the first find.
    void sort();
    std::span<const Entry> find(Edge edge) const;
    std::span<const Entry> all() const { return entries_; }

  private:
    std::vector<Entry> entries_;
};

/// A vertical rectangle of two triangles; corners as in WallKind.
struct WallQuad {
    uint32_t p0, q0, q1, p1;
    std::array<uint32_t, 2> triangles;
    WallKind kind;
};
std::vector<WallQuad> find_walls(const WeldedMesh& mesh);

/// A connected set of horizontal triangles whose points all lie on its border.
struct LevelPart {
    std::vector<uint32_t> triangles;                   ///< of the mesh
    std::vector<std::vector<uint32_t>> rings;          ///< points of each border ring, in the triangles' sense
    std::vector<std::array<uint32_t, 3>> ring_points;  ///< each triangle's corners, counted through the rings
};

/// Horizontal triangles connected across all edges but those on which `walls` stand or hang. Parts with a point inside
/// are left out.
std::vector<LevelPart> find_level_parts(const WeldedMesh& mesh, std::span<const WallQuad> walls);

}  // namespace citystream::codec::mesh
