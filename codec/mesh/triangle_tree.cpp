#include "codec/mesh/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kLeafTriangles = 4;

}  // namespace

TriangleTree::TriangleTree(std::span<const GridPoint> points, std::span<const std::array<uint32_t, 3>> triangles)
    : triangles_(triangles), order_(triangles.size()), boxes_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    if (triangles.empty()) return;
    std::vector<std::array<int64_t, 3>> centres;
    for (const auto& triangle : triangles) {
        std::array<int64_t, 3> centre{};
        for (size_t c = 0; c < 3; ++c) {
            for (const uint32_t v : triangle) centre[c] += points[v][c];
        }
        centres.push_back(centre);
    }
    build(0, static_cast<uint32_t>(triangles.size()), centres);
    refit(points);
}

uint32_t TriangleTree::build(uint32_t first, uint32_t count, std::span<const std::array<int64_t, 3>> centres) {
    const auto node = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({{}, first, count, 0});
    if (count <= kLeafTriangles) return node;
    const auto begin = order_.begin() + first, end = begin + count;
    size_t axis = 0;
    int64_t widest = -1;
    for (size_t c = 0; c < 3; ++c) {
        const auto [low, high] =
            std::minmax_element(begin, end, [&](uint32_t a, uint32_t b) { return centres[a][c] < centres[b][c]; });
        const int64_t extent = centres[*high][c] - centres[*low][c];
        if (extent > widest) {
            widest = extent;
            axis = c;
        }
    }
    std::nth_element(begin, begin + count / 2, end, [&](uint32_t a, uint32_t b) {
        return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
    });
    build(first, count / 2, centres);
    const uint32_t right = build(first + count / 2, count - count / 2, centres);
    nodes_[node].right = right;
    return node;
}

TriangleTree::Box TriangleTree::box_of(std::span<const GridPoint> points, const Node& leaf) const {
    Box box = {points[triangles_[order_[leaf.first]][0]], points[triangles_[order_[leaf.first]][0]]};
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        for (const uint32_t v : triangles_[order_[i]]) {
            for (size_t c = 0; c < 3; ++c) {
                box.low[c] = std::min(box.low[c], points[v][c]);
                box.high[c] = std::max(box.high[c], points[v][c]);
            }
        }
    }
    return box;
}

void TriangleTree::refit(std::span<const GridPoint> points) {
    for (uint32_t i = 0; i < order_.size(); ++i) boxes_[order_[i]] = box_of(points, {{}, i, 1, 0});
    // Children follow their parents.
    for (size_t n = nodes_.size(); n-- > 0;) {
        Node& node = nodes_[n];
        if (node.right == 0) {
            node.box = box_of(points, node);
            continue;
        }
        node.box = nodes_[n + 1].box;
        const Box& right = nodes_[node.right].box;
        for (size_t c = 0; c < 3; ++c) {
            node.box.low[c] = std::min(node.box.low[c], right.low[c]);
            node.box.high[c] = std::max(node.box.high[c], right.high[c]);
        }
    }
}

bool TriangleTree::meet(const Box& a, const Box& b) {
    for (size_t c = 0; c < 3; ++c) {
        if (a.low[c] > b.high[c] || b.low[c] > a.high[c]) return false;
    }
    return true;
}

void TriangleTree::pairs_of_leaves(const Node& a, const Node& b,
                                   const std::function<void(uint32_t, uint32_t)>& take) const {
    for (uint32_t i = a.first; i < a.first + a.count; ++i) {
        for (uint32_t j = &a == &b ? i + 1 : b.first; j < b.first + b.count; ++j) {
            const uint32_t s = order_[i], t = order_[j];
            if (meet(boxes_[s], boxes_[t])) take(std::min(s, t), std::max(s, t));
        }
    }
}

void TriangleTree::pairs_between(uint32_t a, uint32_t b, const std::function<void(uint32_t, uint32_t)>& take) const {
    const Node &left = nodes_[a], &right = nodes_[b];
    if (!meet(left.box, right.box)) return;
    if (left.right == 0 && right.right == 0) return pairs_of_leaves(left, right, take);
    if (right.right == 0 || (left.right != 0 && left.count >= right.count)) {
        pairs_between(a + 1, b, take);
        pairs_between(left.right, b, take);
    } else {
        pairs_between(a, b + 1, take);
        pairs_between(a, right.right, take);
    }
}

void TriangleTree::pairs_within(uint32_t node, const std::function<void(uint32_t, uint32_t)>& take) const {
    if (nodes_[node].right == 0) return pairs_of_leaves(nodes_[node], nodes_[node], take);
    pairs_within(node + 1, take);
    pairs_within(nodes_[node].right, take);
    pairs_between(node + 1, nodes_[node].right, take);
}

void TriangleTree::each_pair(const std::function<void(uint32_t, uint32_t)>& take) const {
    if (!nodes_.empty()) pairs_within(0, take);
}

}  // namespace citystream::codec::mesh
