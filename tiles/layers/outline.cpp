#include "tiles/layers/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace citystream::tiles::layers {
namespace {

constexpr double kUpward = 0.3;

double cross(const OutlinePoint& o, const OutlinePoint& a, const OutlinePoint& b) {
    return static_cast<double>(a[0] - o[0]) * static_cast<double>(b[1] - o[1]) -
           static_cast<double>(a[1] - o[1]) * static_cast<double>(b[0] - o[0]);
}

/// Distance of p to the segment ab.
double segment_distance(const OutlinePoint& p, const OutlinePoint& a, const OutlinePoint& b) {
    const auto dx = static_cast<double>(b[0] - a[0]), dy = static_cast<double>(b[1] - a[1]);
    const auto px = static_cast<double>(p[0] - a[0]), py = static_cast<double>(p[1] - a[1]);
    const double length = dx * dx + dy * dy;
    const double t = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0.0;
    return std::hypot(px - t * dx, py - t * dy);
}

using EdgeMap = std::map<OutlinePoint, std::vector<OutlinePoint>>;

/// Directed border edges by their start: an edge and its reverse cancel.
EdgeMap border_edges(const quadtree::BuildObject& object, const GridPoint& origin) {
    std::map<std::pair<OutlinePoint, OutlinePoint>, int> count;
    for (const quadtree::BuildTriangle& triangle : object.triangles) {
        const auto& v = triangle.vertex;
        const auto n = quadtree::triangle_normal(object.vertices[v[0]], object.vertices[v[1]], object.vertices[v[2]]);
        if (n[2] <= kUpward * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])) continue;
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint& p = object.vertices[v[k]];
            const GridPoint& q = object.vertices[v[(k + 1) % 3]];
            const OutlinePoint a = {p.x - origin.x, p.y - origin.y}, b = {q.x - origin.x, q.y - origin.y};
            if (a < b) ++count[{a, b}];
            if (b < a) --count[{b, a}];
        }
    }
    EdgeMap edges;
    for (const auto& [edge, balance] : count) {
        for (int i = 0; i < balance; ++i) edges[edge.first].push_back(edge.second);
        for (int i = 0; i < -balance; ++i) edges[edge.second].push_back(edge.first);
    }
    return edges;
}

bool inside(const OutlinePoint& p, const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
    return cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0;
}

}  // namespace

std::vector<Outline> roof_outlines(const quadtree::BuildObject& object, const GridPoint& origin) {
    EdgeMap edges = border_edges(object, origin);
    std::vector<Outline> loops;
    while (!edges.empty()) {
        Outline loop = {edges.begin()->first};
        bool closed = false;
        for (;;) {
            const auto found = edges.find(loop.back());
            if (found == edges.end()) break;
            const OutlinePoint next = found->second.back();
            found->second.pop_back();
            if (found->second.empty()) edges.erase(found);
            closed = next == loop.front();
            if (closed) break;
            loop.push_back(next);
        }
        if (closed && loop.size() >= 3) loops.push_back(std::move(loop));
    }
    return loops;
}

double doubled_area(const Outline& outline) {
    double sum = 0;
    for (size_t i = 2; i < outline.size(); ++i) sum += cross(outline[0], outline[i - 1], outline[i]);
    return sum;
}

void simplify_outline(Outline& outline, double tolerance) {
    while (outline.size() > 3) {
        const size_t n = outline.size();
        double least = std::numeric_limits<double>::max();
        size_t at = 0;
        for (size_t i = 0; i < n; ++i) {
            const double d = segment_distance(outline[i], outline[(i + n - 1) % n], outline[(i + 1) % n]);
            if (d < least) {
                least = d;
                at = i;
            }
        }
        if (least > tolerance) return;
        outline.erase(outline.begin() + static_cast<ptrdiff_t>(at));
    }
}

std::vector<uint32_t> triangulate_outline(const Outline& outline) {
    std::vector<uint32_t> rest(outline.size()), out;
    for (uint32_t i = 0; i < rest.size(); ++i) rest[i] = i;
    while (rest.size() > 3) {
        const size_t n = rest.size();
        bool cut = false;
        for (size_t i = 0; i < n && !cut; ++i) {
            const uint32_t a = rest[(i + n - 1) % n], b = rest[i], c = rest[(i + 1) % n];
            if (cross(outline[a], outline[b], outline[c]) <= 0) continue;
            const bool blocked = std::any_of(rest.begin(), rest.end(), [&](uint32_t p) {
                return p != a && p != b && p != c && inside(outline[p], outline[a], outline[b], outline[c]);
            });
            if (blocked) continue;
            out.insert(out.end(), {a, b, c});
            rest.erase(rest.begin() + static_cast<ptrdiff_t>(i));
            cut = true;
        }
        if (!cut) return {};
    }
    if (rest.size() == 3) out.insert(out.end(), rest.begin(), rest.end());
    return out;
}

Outline oriented_box(const std::vector<OutlinePoint>& points, const std::vector<OutlinePoint>& directions) {
    Outline best;
    double best_area = std::numeric_limits<double>::max();
    for (const OutlinePoint& direction : directions) {
        const double length = std::hypot(static_cast<double>(direction[0]), static_cast<double>(direction[1]));
        if (length <= 0) continue;
        const double ux = static_cast<double>(direction[0]) / length, uy = static_cast<double>(direction[1]) / length;
        std::array<double, 4> range = {1e300, -1e300, 1e300, -1e300};
        for (const OutlinePoint& p : points) {
            const double s = static_cast<double>(p[0]) * ux + static_cast<double>(p[1]) * uy;
            const double t = static_cast<double>(p[1]) * ux - static_cast<double>(p[0]) * uy;
            range = {std::min(range[0], s), std::max(range[1], s), std::min(range[2], t), std::max(range[3], t)};
        }
        const double area = (range[1] - range[0]) * (range[3] - range[2]);
        if (area >= best_area) continue;
        best_area = area;
        const auto corner = [&](size_t s, size_t t) {
            return OutlinePoint{std::llround(range[s] * ux - range[t] * uy),
                                std::llround(range[s] * uy + range[t] * ux)};
        };
        best = {corner(0, 2), corner(1, 2), corner(1, 3), corner(0, 3)};
    }
    return best;
}

}  // namespace citystream::tiles::layers
