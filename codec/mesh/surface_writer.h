// Writes any list of triangles as a walk over their surface (surface_walk.h): which piece comes first, which triangle
// is beyond a gate.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/open_triangles.h"
#include "codec/mesh/surface_walk.h"

namespace citystream::codec::mesh {

/// The mesh with one point for each place, and the triangles with equal corners set apart.
struct WeldedSurface {
    explicit WeldedSurface(const GridMesh& mesh);

    std::vector<GridPoint> points;
    std::vector<uint32_t> point_of;  ///< of each point of the mesh
    std::vector<std::array<uint32_t, 3>> triangles, flat;
    std::vector<uint32_t> triangle_source, flat_source;  ///< of each triangle, which one of the mesh it is
};

/// Where a walk's points lie, all shifted right by the bits that its step drops.
struct SurfaceBox {
    GridPoint low{}, extent{};  ///< extent: highest - lowest
    uint32_t cell_bits = 1;     ///< of NearPoints

    WalkFrame frame(uint32_t most_points, uint32_t most_triangles) const {
        return {extent, cell_bits, most_points, most_triangles};
    }
};
inline constexpr uint32_t kMostCellBits = 30;

/// Of the points that a triangle uses.
SurfaceBox box_of(const WeldedSurface& mesh, uint32_t dropped);

class SurfaceWriter {
  public:
    /// Borrows both.
    SurfaceWriter(const WeldedSurface& mesh, const SurfaceBox& box, uint32_t dropped);
    /// All triangles; to be called once.
    void write(bits::RangeEncoder& coder);

    const SurfaceWalk& walk() const { return walk_; }
    /// The welded points in the order of the walk.
    const std::vector<uint32_t>& points() const { return points_; }
    /// The triangles of the unwelded mesh in the order of the walk, which may have turned their corners.
    const std::vector<uint32_t>& triangles() const { return triangles_; }

  private:
    using Triangle = std::array<uint32_t, 3>;
    WalkCorner corner_at(uint32_t vertex);
    uint32_t triangle_beyond(const MeshBorder::Gate& gate, uint32_t& apex) const;
    uint32_t known_corners(const Triangle& t) const;
    uint32_t triangle_at_known_point();
    void take(uint32_t triangle);
    void write_piece(bits::RangeEncoder& coder, Triangle first, uint32_t index);

    const WeldedSurface& mesh_;
    const SurfaceBox& box_;
    uint32_t dropped_;
    OpenTriangles open_;
    SurfaceWalk walk_;
    std::vector<uint32_t> walked_;  ///< of each welded point its place in the walk
    std::vector<uint32_t> points_, triangles_;
    size_t complete_ = 0;  ///< points at the front of points_ that no open triangle has
};

}  // namespace citystream::codec::mesh
