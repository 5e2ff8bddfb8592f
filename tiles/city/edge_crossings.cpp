#include "tiles/city/edge_crossings.h"

#include <algorithm>
#include <vector>

namespace citystream::tiles::city {
namespace {

/// With fewer edges even every pair crossing is little work.
constexpr size_t kFewEdges = 128;
constexpr uint64_t kMostTests = uint64_t{1} << 26;

struct Edge {
    Vec2 a, b;
    double left, right, low, high;
};

double side(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Edges that share an end do not count.
bool properly_cross(const Edge& e, const Edge& f) {
    return side(e.a, e.b, f.a) * side(e.a, e.b, f.b) < 0 && side(f.a, f.b, e.a) * side(f.a, f.b, e.b) < 0;
}

std::vector<Edge> edges_of(std::span<const Vec2> points, std::span<const uint32_t> ring_ends) {
    std::vector<Edge> edges;
    edges.reserve(points.size());
    uint32_t begin = 0;
    for (const uint32_t end : ring_ends) {
        for (uint32_t i = begin; i < end; ++i) {
            const Vec2 a = points[i], b = points[i + 1 == end ? begin : i + 1];
            edges.push_back({a, b, std::min(a.x, b.x), std::max(a.x, b.x), std::min(a.y, b.y), std::max(a.y, b.y)});
        }
        begin = end;
    }
    return edges;
}

}  // namespace

bool too_many_crossings(std::span<const Vec2> points, std::span<const uint32_t> ring_ends) {
    if (points.size() <= kFewEdges) return false;
    std::vector<Edge> edges = edges_of(points, ring_ends);
    std::stable_sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.left < f.left; });
    const uint64_t most_crossings = 2 * points.size() + 64;
    uint64_t crossings = 0, tests = 0;
    std::vector<size_t> active;
    for (size_t i = 0; i < edges.size(); ++i) {
        const Edge& edge = edges[i];
        std::erase_if(active, [&](size_t other) { return edges[other].right < edge.left; });
        tests += active.size() + 1;
        if (tests > kMostTests) return true;
        for (const size_t other : active) {
            const Edge& f = edges[other];
            if (f.low <= edge.high && edge.low <= f.high && properly_cross(edge, f)) ++crossings;
        }
        if (crossings > most_crossings) return true;
        active.push_back(i);
    }
    return false;
}

}  // namespace citystream::tiles::city
