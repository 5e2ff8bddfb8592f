#include "tiles/layers/dress_cut.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers {
namespace {

using Triangles = std::vector<std::array<WallPoint, 3>>;

bool level(const WallEdge& edge) {
    return edge.from.z == edge.to.z;
}
bool upright(const WallEdge& edge) {
    return edge.from.column == edge.to.column;
}

/// Whether all points of a chain stand above the line through its ends, exactly.
bool straight(const WallRegion& wall, const std::vector<WallPoint>& chain) {
    const auto &a = wall.columns[chain.front().column], &b = wall.columns[chain.back().column];
    return std::all_of(chain.begin(), chain.end(), [&](const WallPoint& point) {
        const auto& p = wall.columns[point.column];
        return (b[0] - a[0]) * (p[1] - a[1]) == (b[1] - a[1]) * (p[0] - a[0]);
    });
}

/// A fan over the loop that runs there along one chain and back along the other (both with the same ends). Its edges
/// cancel whatever its shape.
void add_sliver(const WallRegion& wall, const std::vector<WallPoint>& there, const std::vector<WallPoint>& back,
                Triangles& slivers) {
    if (straight(wall, there) && straight(wall, back)) return;
    std::vector<WallPoint> loop(there);
    for (size_t i = back.size() - 1; i-- > 1;) loop.push_back(back[i]);
    for (size_t i = 2; i < loop.size(); ++i) slivers.push_back({loop[0], loop[i - 1], loop[i]});
}

/// Twice the signed area of a loop, metres squared, counter-clockwise from outside positive; and its length.
struct LoopSize {
    double area = 0, around = 0;
};
LoopSize size_of(const WallRegion& wall, const std::vector<WallPoint>& loop) {
    LoopSize size;
    const auto place = [&](const WallPoint& p) {
        return city::Vec2{wall.along[p.column], static_cast<double>(p.z - loop[0].z) * kMetresPerGridUnit};
    };
    for (size_t i = 0; i < loop.size(); ++i) {
        const city::Vec2 a = place(loop[i]), b = place(loop[(i + 1) % loop.size()]);
        size.area += a.x * b.y - a.y * b.x;
        size.around += std::hypot(b.x - a.x, b.y - a.y);
    }
    return size;
}

void fan(const std::vector<WallPoint>& loop, Triangles& triangles) {
    for (size_t i = 2; i < loop.size(); ++i) triangles.push_back({loop[0], loop[i - 1], loop[i]});
}

}  // namespace

/// Points strictly between the ends of a level or upright line, in its order.
std::vector<WallPoint> WallCutter::between(const WallPoint& from, const WallPoint& to) const {
    std::vector<WallPoint> found;
    const WallPoint low = std::min(from, to), high = std::max(from, to);
    const bool is_level = from.z == to.z;
    for (auto at = std::upper_bound(points_.begin(), points_.end(), low); at != points_.end() && *at < high; ++at)
        if (is_level ? at->z == from.z && at->column > low.column && at->column < high.column
                     : at->column == from.column)
            found.push_back(*at);
    if (to < from) std::reverse(found.begin(), found.end());
    return found;
}

bool WallCutter::cut(const WallRegion& wall, const std::vector<CutRectangle>& rectangles, int64_t floor,
                     Triangles& triangles) {
    triangles.clear();
    points_.clear();
    edges_.clear();
    for (const WallEdge& edge : wall.outline) points_.insert(points_.end(), {edge.from, edge.to});
    for (const CutRectangle& cut : rectangles) {
        const LevelRectangle& r = cut.rectangle;
        points_.insert(points_.end(), {{r.left, r.bottom}, {r.right, r.bottom}, {r.right, r.top}, {r.left, r.top}});
    }
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    Triangles slivers;
    split_outline(wall, floor, slivers);
    for (const CutRectangle& cut : rectangles) take_out(wall, cut, floor, slivers);
    std::vector<Loop> loops;
    if (!trace_loops(loops) || !triangulate(wall, loops, triangles)) return false;
    triangles.insert(triangles.end(), slivers.begin(), slivers.end());
    return true;
}

void WallCutter::split_outline(const WallRegion& wall, int64_t floor, Triangles& slivers) {
    for (const WallEdge& edge : wall.outline) {
        if (!level(edge) && !upright(edge)) {
            edges_.push_back(edge);
            continue;
        }
        std::vector<WallPoint> chain = between(edge.from, edge.to);
        chain.insert(chain.begin(), edge.from);
        chain.push_back(edge.to);
        for (size_t i = 1; i < chain.size(); ++i) edges_.push_back({chain[i - 1], chain[i]});
        if (level(edge) && edge.from.z != floor) add_sliver(wall, {edge.from, edge.to}, chain, slivers);
    }
}

void WallCutter::take_out(const WallRegion& wall, const CutRectangle& cut, int64_t floor, Triangles& slivers) {
    const LevelRectangle& r = cut.rectangle;
    const std::array<WallPoint, 5> corners = {
        {{r.left, r.bottom}, {r.right, r.bottom}, {r.right, r.top}, {r.left, r.top}, {r.left, r.bottom}}};
    for (size_t side = 0; side < 4; ++side) {
        std::vector<WallPoint> chain = between(corners[side], corners[side + 1]);
        chain.insert(chain.begin(), corners[side]);
        chain.push_back(corners[side + 1]);
        for (size_t i = 1; i < chain.size(); ++i) edges_.push_back({chain[i], chain[i - 1]});
        if (side % 2 == 1 || corners[side].z == floor) continue;
        std::vector<WallPoint> facades;
        for (uint32_t seam : cut.seams) facades.push_back({seam, corners[side].z});
        if (side == 2) std::reverse(facades.begin(), facades.end());
        add_sliver(wall, chain, facades, slivers);
    }
}

/// Cancels opposite edges and strings the rest to loops.
bool WallCutter::trace_loops(std::vector<Loop>& loops) {
    const auto ends = [](const WallEdge& e) { return std::pair(std::min(e.from, e.to), std::max(e.from, e.to)); };
    std::sort(edges_.begin(), edges_.end(), [&](const WallEdge& a, const WallEdge& b) {
        const auto ea = ends(a), eb = ends(b);
        return ea != eb ? ea < eb : a < b;
    });
    std::vector<WallEdge> rest;
    for (size_t i = 0; i < edges_.size();) {
        size_t end = i;
        int net = 0;
        for (; end < edges_.size() && ends(edges_[end]) == ends(edges_[i]); ++end)
            net += edges_[end].from < edges_[end].to ? 1 : -1;
        const auto [low, high] = ends(edges_[i]);
        if (std::abs(net) > 1) return false;
        if (net > 0) rest.push_back({low, high});
        if (net < 0) rest.push_back({high, low});
        i = end;
    }
    std::sort(rest.begin(), rest.end());
    std::vector<bool> used(rest.size());
    for (size_t first = 0; first < rest.size(); ++first) {
        if (used[first]) continue;
        Loop loop;
        for (size_t at = first; !used[at];) {
            used[at] = true;
            loop.push_back(rest[at].from);
            if (rest[at].to == rest[first].from) break;
            auto next = std::lower_bound(rest.begin(), rest.end(), WallEdge{rest[at].to, {}});
            while (next != rest.end() && next->from == rest[at].to && used[static_cast<size_t>(next - rest.begin())])
                ++next;
            if (next == rest.end() || !(next->from == rest[at].to)) return false;
            at = static_cast<size_t>(next - rest.begin());
        }
        loops.push_back(std::move(loop));
    }
    return true;
}

bool WallCutter::triangulate(const WallRegion& wall, const std::vector<Loop>& loops, Triangles& triangles) {
    constexpr double kThin = 0.004;  // area by length: metres
    std::vector<const Loop*> wide;
    double greatest = 0;
    for (const Loop& loop : loops) {
        const LoopSize size = size_of(wall, loop);
        const bool alone = loop.size() == 3 && loops.size() == 1;
        if (alone || std::abs(size.area) < kThin * size.around) {
            fan(loop, triangles);
        } else {
            wide.push_back(&loop);
            if (size.area > greatest) {
                greatest = size.area;
                std::swap(wide.front(), wide.back());
            }
        }
    }
    if (wide.empty()) return true;
    if (greatest <= 0) return false;
    std::vector<city::Corner> corners;
    std::vector<WallPoint> points;
    std::vector<uint32_t> ends;
    for (const Loop* loop : wide) {
        for (const WallPoint& p : *loop) {
            corners.push_back({{wall.along[p.column], 0, to_metres(p.z)}, {}});
            points.push_back(p);
        }
        ends.push_back(static_cast<uint32_t>(corners.size()));
    }
    std::vector<std::array<uint32_t, 3>> made;
    const city::PolygonOutcome outcome = triangulator_.triangulate(corners, ends, made);
    if (outcome.fault != city::PolygonFault::kNone || outcome.crosses_itself) return false;
    for (size_t i = points.size(); i < corners.size(); ++i) {
        // Loops that touch give their common point once more.
        const auto same = std::find_if(points.begin(), points.end(), [&](const WallPoint& p) {
            return std::abs(wall.along[p.column] - corners[i].position.x) < 1e-6 &&
                   std::abs(to_metres(p.z) - corners[i].position.z) < 1e-6;
        });
        if (same == points.end()) return false;
        points.push_back(*same);
    }
    for (const auto& t : made) triangles.push_back({points[t[0]], points[t[1]], points[t[2]]});
    return true;
}

}  // namespace citystream::tiles::layers
