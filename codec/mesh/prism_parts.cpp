#include "codec/mesh/prism_parts.h"

#include <algorithm>

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = WeldedMesh::kNone;
using Indices = std::array<uint32_t, 3>;

/// A triangle that could be half of a wall: its level edge a -> b first, then the third corner.
struct WallHalf {
    uint32_t a, b, c;
    bool lower;  ///< the level edge is at the base
    bool first;  ///< the third corner is over (or under) a, not b
};

bool as_wall_half(const WeldedMesh& mesh, const Indices& triangle, WallHalf& half) {
    for (uint32_t turn = 0; turn < 3; ++turn) {
        const uint32_t a = triangle[turn], b = triangle[(turn + 1) % 3], c = triangle[(turn + 2) % 3];
        if (mesh.height(a) != mesh.height(b) || mesh.same_place(a, b) || mesh.height(c) == mesh.height(a)) continue;
        half = {a, b, c, mesh.height(c) > mesh.height(a), mesh.same_place(c, a)};
        return half.first || mesh.same_place(c, b);
    }
    return false;
}

/// The two horizontal sides of a border edge: half edge h of triangle t is 3 t + h, from corner h to the next.
class LevelEdges {
  public:
    LevelEdges(const WeldedMesh& mesh, std::span<const WallQuad> walls) : mesh_(mesh) {
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            if (a == b || b == c || c == a) continue;
            if (mesh.height(a) == mesh.height(b) && mesh.height(b) == mesh.height(c)) level_.push_back(t);
        }
        find_mates(walls);
    }
    const std::vector<uint32_t>& level_triangles() const { return level_; }
    uint32_t from(uint32_t half_edge) const { return mesh_.triangles[half_edge / 3][half_edge % 3]; }
    uint32_t mate(uint32_t half_edge) const { return mates_[half_edge]; }
    static uint32_t next(uint32_t half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }

  private:
    /// Joins half edges p -> q and q -> p, the first of one kind to the first of the other and so on.
    void find_mates(std::span<const WallQuad> walls) {
        EdgeIndex borders, halves;
        for (const WallQuad& wall : walls) {
            borders.add({wall.p1, wall.q1}, 0);
            borders.add({wall.q0, wall.p0}, 0);
        }
        borders.sort();
        for (const uint32_t t : level_) {
            for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                const Edge edge = {from(h), from(next(h))};
                if (borders.find(edge).empty()) halves.add(edge, h);
            }
        }
        halves.sort();
        mates_.assign(3 * mesh_.triangles.size(), kNone);
        const auto all = halves.all();
        for (size_t begin = 0, end = 0; begin < all.size(); begin = end) {
            const Edge edge = all[begin].first;
            while (end < all.size() && all[end].first == edge) ++end;
            if (edge.first > edge.second) continue;
            const auto others = halves.find({edge.second, edge.first});
            for (size_t i = 0; i < std::min(end - begin, others.size()); ++i) {
                mates_[all[begin + i].second] = others[i].second;
                mates_[others[i].second] = all[begin + i].second;
            }
        }
    }

    const WeldedMesh& mesh_;
    std::vector<uint32_t> level_;
    std::vector<uint32_t> mates_;
};

/// Walks one connected part after another.
class PartFinder {
  public:
    PartFinder(const WeldedMesh& mesh, const LevelEdges& edges)
        : edges_(edges), seen_(mesh.triangles.size()), ring_point_(3 * mesh.triangles.size(), kNone) {}

    bool seen(uint32_t triangle) const { return seen_[triangle]; }
    /// All triangles connected to `first`; false when the part has a point inside.
    bool find(uint32_t first, LevelPart& part) {
        part = {{first}, {}, {}};
        seen_[first] = true;
        for (size_t i = 0; i < part.triangles.size(); ++i) {
            for (uint32_t h = 3 * part.triangles[i]; h < 3 * part.triangles[i] + 3; ++h) {
                const uint32_t mate = edges_.mate(h);
                if (mate == kNone || seen_[mate / 3]) continue;
                seen_[mate / 3] = true;
                part.triangles.push_back(mate / 3);
            }
        }
        uint32_t count = 0;
        for (const uint32_t t : part.triangles) {
            for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
                if (edges_.mate(h) == kNone && ring_point_[h] == kNone) walk_ring(h, count, part);
            }
        }
        for (const uint32_t t : part.triangles) {
            const Indices corners = {ring_point_[3 * t], ring_point_[3 * t + 1], ring_point_[3 * t + 2]};
            if (std::find(corners.begin(), corners.end(), kNone) != corners.end()) return false;
            part.ring_points.push_back(corners);
        }
        return true;
    }

  private:
    /// Follows the border from a border half edge, and gives all corners at each of its points that point's number.
    void walk_ring(uint32_t border, uint32_t& count, LevelPart& part) {
        auto& ring = part.rings.emplace_back();
        for (uint32_t h = border; ring_point_[h] == kNone;) {
            ring.push_back(edges_.from(h));
            ring_point_[h] = count;
            // Around the point that h starts at, against the clock: the half edge before h, its mate, and so on.
            for (uint32_t mate = edges_.mate(before(h)); mate != kNone; mate = edges_.mate(before(mate)))
                ring_point_[mate] = count;
            ++count;
            // To the border edge that starts where h ends: around that point with the clock.
            h = LevelEdges::next(h);
            while (edges_.mate(h) != kNone) h = LevelEdges::next(edges_.mate(h));
        }
    }
    static uint32_t before(uint32_t half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }

    const LevelEdges& edges_;
    std::vector<bool> seen_;
    std::vector<uint32_t> ring_point_;
};

}  // namespace

WeldedMesh::WeldedMesh(const GridMesh& mesh) : points(mesh.points) {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::vector<uint32_t> number;
    number.reserve(mesh.points.size());
    for (const GridPoint& point : mesh.points)
        number.push_back(static_cast<uint32_t>(std::lower_bound(points.begin(), points.end(), point) - points.begin()));
    triangles.reserve(mesh.triangles.size());
    for (const Indices& t : mesh.triangles) triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
}

uint32_t WeldedMesh::at_height(uint32_t point, int32_t height) const {
    const GridPoint wanted = {points[point][0], points[point][1], height};
    const auto at = std::lower_bound(points.begin(), points.end(), wanted);
    return at != points.end() && *at == wanted ? static_cast<uint32_t>(at - points.begin()) : kNone;
}

void EdgeIndex::sort() {
    std::sort(entries_.begin(), entries_.end());
}

std::span<const EdgeIndex::Entry> EdgeIndex::find(Edge edge) const {
    const auto begin = std::lower_bound(entries_.begin(), entries_.end(), Entry{edge, 0});
    return {begin, std::upper_bound(begin, entries_.end(), Entry{edge, ~uint32_t{0}})};
}

std::vector<WallQuad> find_walls(const WeldedMesh& mesh) {
    std::vector<WallHalf> halves(mesh.triangles.size());
    std::vector<uint32_t> lower;
    EdgeIndex upper;  // by the diagonal, in the direction in which the lower half runs along it
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        WallHalf& half = halves[t];
        if (!as_wall_half(mesh, mesh.triangles[t], half)) continue;
        if (half.lower)
            lower.push_back(t);
        else
            upper.add(half.first ? Edge{half.c, half.b} : Edge{half.a, half.c}, t);
    }
    upper.sort();
    std::vector<uint32_t> used(upper.all().size());  // of each diagonal's halves, at its first
    std::vector<WallQuad> walls;
    for (const uint32_t t : lower) {
        const WallHalf& half = halves[t];
        const auto others = upper.find(half.first ? Edge{half.b, half.c} : Edge{half.c, half.a});
        if (others.empty()) continue;
        uint32_t& next = used[static_cast<size_t>(others.data() - upper.all().data())];
        if (next == others.size()) continue;
        const uint32_t other = others[next++].second;
        const WallHalf& top = halves[other];
        walls.push_back(
            {half.a, half.b, top.a, top.b, {t, other}, half.first ? WallKind::kFalling : WallKind::kRising});
    }
    return walls;
}

std::vector<LevelPart> find_level_parts(const WeldedMesh& mesh, std::span<const WallQuad> walls) {
    const LevelEdges edges(mesh, walls);
    PartFinder finder(mesh, edges);
    std::vector<LevelPart> parts;
    LevelPart part;
    for (const uint32_t t : edges.level_triangles()) {
        if (!finder.seen(t) && finder.find(t, part)) parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace citystream::codec::mesh
