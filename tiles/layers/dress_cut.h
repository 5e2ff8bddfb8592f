// What remains of a wall once rectangles are taken out of it: triangles that close the surface exactly, on the grid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tiles/city/triangulate.h"
#include "tiles/layers/dress_rectangles.h"

namespace citystream::tiles::layers {

/// A rectangle with the columns between which its facades stand (its own left and right among them, rising).
struct CutRectangle {
    LevelRectangle rectangle;
    std::vector<uint32_t> seams;
};

/// Triangles over WallPoints, counter-clockwise from outside. Fails (false) when the rest cannot be triangulated; the
/// wall then has to stay whole.
///
/// Every directed edge of the outline is kept, so neighbouring faces meet it as before: facades, rest and neighbours
/// together bound the same closed surface. Where a straight facade replaces an outline that bends by a hair (up to
/// kFlatness), or a seam lies off its edge by rounding, flat slivers fill the gap; gaps at the height `floor` stay open
/// (nobody sees under a house). O(n log n) for n corners but for the triangulation.
class WallCutter {
  public:
    bool cut(const WallRegion& wall, const std::vector<CutRectangle>& rectangles, int64_t floor,
             std::vector<std::array<WallPoint, 3>>& triangles);

  private:
    using Loop = std::vector<WallPoint>;
    void split_outline(const WallRegion& wall, int64_t floor, std::vector<std::array<WallPoint, 3>>& slivers);
    void take_out(const WallRegion& wall, const CutRectangle& rectangle, int64_t floor,
                  std::vector<std::array<WallPoint, 3>>& slivers);
    std::vector<WallPoint> between(const WallPoint& from, const WallPoint& to) const;
    bool trace_loops(std::vector<Loop>& loops);
    bool triangulate(const WallRegion& wall, const std::vector<Loop>& loops,
                     std::vector<std::array<WallPoint, 3>>& triangles);

    std::vector<WallPoint> points_;  ///< of outline and rectangles, sorted
    std::vector<WallEdge> edges_;
    city::Triangulator triangulator_;
};

}  // namespace citystream::tiles::layers
