#include "codec/mesh/depth_order.h"

#include <algorithm>
#include <cassert>

#include "codec/mesh/constrained_precision.h"
#include "codec/mesh/triangle_crossing.h"
#include "codec/mesh/triangle_tree.h"

namespace citystream::codec::mesh {
namespace {

using Pairs = std::vector<std::array<uint32_t, 2>>;

/// Triangles at full precision, and where their corners are now.
class MovedTriangles {
  public:
    MovedTriangles(std::span<const GridPoint> points, std::span<const std::array<uint32_t, 3>> triangles,
                   std::span<const uint32_t> object, const PrecisionGrid& grid)
        : points_(points), triangles_(triangles), object_(object), grid_(grid), tree_(points, triangles) {
        assert(object.size() == triangles.size());
    }

    Pairs meetings(std::span<const uint32_t> dropped) {
        now_.clear();
        for (size_t v = 0; v < points_.size(); ++v)
            now_.push_back(grid_.point_of(grid_.words_of(points_[v]), dropped[v]));
        tree_.refit(now_);
        Pairs pairs;
        tree_.each_pair([&](uint32_t a, uint32_t b) {
            if (object_[a] != object_[b] && triangles_meet(at(now_, a), at(now_, b)) &&
                !triangles_meet(at(points_, a), at(points_, b)))
                pairs.push_back({a, b});
        });
        return pairs;
    }

  private:
    GridTriangle at(std::span<const GridPoint> points, uint32_t triangle) const {
        const auto [a, b, c] = triangles_[triangle];
        return {points[a], points[b], points[c]};
    }

    std::span<const GridPoint> points_;
    std::span<const std::array<uint32_t, 3>> triangles_;
    std::span<const uint32_t> object_;
    const PrecisionGrid& grid_;
    TriangleTree tree_;
    std::vector<GridPoint> now_;
};

}  // namespace

Pairs new_meetings(std::span<const GridPoint> points, std::span<const std::array<uint32_t, 3>> triangles,
                   std::span<const uint32_t> object, const PrecisionGrid& grid, std::span<const uint32_t> dropped) {
    return MovedTriangles(points, triangles, object, grid).meetings(dropped);
}

std::vector<uint32_t> depth_order_dropped(std::span<const GridPoint> points,
                                          std::span<const std::array<uint32_t, 3>> triangles,
                                          std::span<const uint32_t> object, const PrecisionGrid& grid) {
    MovedTriangles moved(points, triangles, object, grid);
    std::vector<uint32_t> most(points.size(), grid.common_dropped);
    std::vector<uint32_t> dropped(points.size(), 0);
    for (uint32_t level = 1; level <= grid.common_dropped; ++level) {
        // A pair whose vertices have all gone back is as it was a level before, where it did not meet: this ends.
        while (true) {
            for (size_t v = 0; v < dropped.size(); ++v) dropped[v] = std::min(level, most[v]);
            const Pairs pairs = moved.meetings(dropped);
            if (pairs.empty()) break;
            for (const auto& pair : pairs) {
                for (const uint32_t triangle : pair) {
                    for (const uint32_t v : triangles[triangle]) most[v] = std::min(most[v], level - 1);
                }
            }
            share_among_duplicates(points, most);
        }
    }
    return most;
}

}  // namespace citystream::codec::mesh
