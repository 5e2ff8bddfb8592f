// A tree of boxes over triangles that move a little: finds the pairs whose boxes meet.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

class TriangleTree {
  public:
    /// The tree's order follows the triangles' places at `points`. O(triangles log^2 triangles), deterministic. The
    /// triangles outlive the tree.
    TriangleTree(std::span<const GridPoint> points, std::span<const std::array<uint32_t, 3>> triangles);

    /// Boxes around the triangles where their points are now. O(triangles).
    void refit(std::span<const GridPoint> points);

    /// Every pair (a < b) of different triangles whose closed boxes meet, once, in an order that depends on nothing
    /// but the input. O(pairs + triangles log triangles) as long as the boxes are spread out.
    void each_pair(const std::function<void(uint32_t, uint32_t)>& take) const;

  private:
    struct Box {
        GridPoint low, high;
    };
    struct Node {
        Box box;
        uint32_t first = 0, count = 0;  ///< of order_
        uint32_t right = 0;             ///< node; the left one follows its parent. 0: a leaf
    };
    uint32_t build(uint32_t first, uint32_t count, std::span<const std::array<int64_t, 3>> centres);
    Box box_of(std::span<const GridPoint> points, const Node& leaf) const;
    void pairs_within(uint32_t node, const std::function<void(uint32_t, uint32_t)>& take) const;
    void pairs_between(uint32_t a, uint32_t b, const std::function<void(uint32_t, uint32_t)>& take) const;
    void pairs_of_leaves(const Node& a, const Node& b, const std::function<void(uint32_t, uint32_t)>& take) const;
    static bool meet(const Box& a, const Box& b);

    std::span<const std::array<uint32_t, 3>> triangles_;
    std::vector<uint32_t> order_;
    std::vector<Box> boxes_;  ///< of each triangle
    std::vector<Node> nodes_;
};

}  // namespace citystream::codec::mesh
