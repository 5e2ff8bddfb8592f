// Vertical walls and a flat top: the parts of a triangle mesh that are a footprint times a height.
//
// Most of a city is of this kind, and such a part needs far less than its triangles: the rings of the footprint, two
// heights, and how the faces were cut into triangles. split_prisms finds these parts in any mesh on the grid, also
// where they stand among others; all triangles that are not exactly in such a part stay in the remainder. Nothing is
// lost, moved, turned over or triangulated anew: join(split_prisms(mesh)) is the same mesh (grid_mesh.h).
//
// What is found: a connected set of horizontal triangles (the top) without points inside, whose border edges stand on
// walls, each a rectangle of two triangles. Most walls reach down to the prism's base, others to a base of their own,
// as where a roof meets a higher part; at most half of the border edges may have none, as between houses that lean on
// each other. If the horizontal triangles at the base are bordered by the same rings turned round, they are the prism's
// floor. Edges are matched by position, so points need not be shared.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

/// Ring points from above. The outer ring comes first and runs counter-clockwise; holes run clockwise. The last point
/// is joined to the first. Points may come twice where a ring touches itself.
struct Ring {
    std::vector<std::array<int32_t, 2>> points;
};

/// How the wall from a ring point p to the next point q is made. From outside p is left; 0 is at its base, 1 at the
/// top.
enum class WallKind : uint8_t {
    kRising = 0,   ///< (p0, q0, q1) and (p0, q1, p1)
    kFalling = 1,  ///< (p0, q0, p1) and (q0, q1, p1)
    kOpen = 2      ///< there is none
};
struct PrismWall {
    WallKind kind = WallKind::kOpen;
    int32_t base = 0;  ///< below the top; that of the prism where there is no wall
    friend bool operator==(const PrismWall&, const PrismWall&) = default;
};

struct Prism {
    std::vector<Ring> rings;
    int32_t base = 0, top = 0;  ///< base < top
    bool has_floor = false;
    std::vector<PrismWall> walls;  ///< one for each point of the rings, in order
    /// Indices of points, counted through the rings. Seen from above the top's run counter-clockwise (as far as they
    /// have an area), the floor's clockwise.
    std::vector<std::array<uint32_t, 3>> top_triangles, floor_triangles;
};

struct PrismSplit {
    std::vector<Prism> prisms;
    GridMesh remainder;
};

/// Deterministic. O(n log n) for n triangles: where walls or parts stand on the same edges by the thousand, as in no
/// city, the search ends early. Triangles with an index that is no point's are a programming error.
PrismSplit split_prisms(const GridMesh& mesh);

/// All triangles of prisms and remainder; points are not shared between prisms.
GridMesh join(const PrismSplit& split);

/// All coordinates >> dropped (0..30).
Prism without_low_bits(Prism prism, uint32_t dropped);
/// All coordinates << dropped: the bits that are missing are 0.
Prism with_low_bits(Prism prism, uint32_t dropped);

}  // namespace citystream::codec::mesh
