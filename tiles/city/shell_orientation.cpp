#include "tiles/city/shell_orientation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace citystream::tiles::city {
namespace {

Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec3 normal_of(const std::vector<Vec3>& vertices, const Triangle& t) {
    const Vec3& a = vertices[t.vertex[0]];
    return cross(minus(vertices[t.vertex[1]], a), minus(vertices[t.vertex[2]], a));
}

void turn(Triangle& t) {
    std::swap(t.vertex[1], t.vertex[2]);
    std::swap(t.texcoord[1], t.texcoord[2]);
}

/// One side of a triangle; `upward` when it runs from the lower vertex to the higher.
struct Side {
    uint32_t low, high, triangle;
    bool upward;
};

struct Neighbour {
    uint32_t triangle;
    bool agrees;
};

class EdgeGraph {
  public:
    explicit EdgeGraph(std::span<const Triangle> shell) : neighbours_(shell.size()) {
        std::vector<Side> sides;
        sides.reserve(3 * shell.size());
        for (uint32_t i = 0; i < shell.size(); ++i) {
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = shell[i].vertex[k], b = shell[i].vertex[(k + 1) % 3];
                sides.push_back({std::min(a, b), std::max(a, b), i, a < b});
            }
        }
        std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
            return s.low != t.low ? s.low < t.low : (s.high != t.high ? s.high < t.high : s.triangle < t.triangle);
        });
        for (size_t i = 0; i < sides.size();) {
            size_t end = i + 1;
            while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
            if (end - i == 2)
                link(sides[i], sides[i + 1]);
            else
                closed_ = false;
            i = end;
        }
    }
    bool closed() const { return closed_; }
    bool consistent() const { return consistent_; }
    const std::vector<std::vector<Neighbour>>& neighbours() const { return neighbours_; }

  private:
    void link(const Side& s, const Side& t) {
        const bool agrees = s.upward != t.upward;
        consistent_ = consistent_ && agrees;
        neighbours_[s.triangle].push_back({t.triangle, agrees});
        neighbours_[t.triangle].push_back({s.triangle, agrees});
    }
    std::vector<std::vector<Neighbour>> neighbours_;
    bool closed_ = true, consistent_ = true;
};

double volume_of(const std::vector<Vec3>& vertices, std::span<const Triangle> shell, std::span<const uint32_t> which) {
    const Vec3 origin = vertices[shell[which[0]].vertex[0]];
    double volume = 0;
    for (const uint32_t i : which) {
        volume += dot(minus(vertices[shell[i].vertex[0]], origin), normal_of(vertices, shell[i]));
    }
    return volume;
}

ShellRepair turn_looking_closed(const std::vector<Vec3>& vertices, std::span<Triangle> shell, bool cavity) {
    const Vec3 origin = vertices[shell[0].vertex[0]];
    Vec3 total;
    double area = 0, volume = 0;
    for (const Triangle& t : shell) {
        const Vec3 n = normal_of(vertices, t);
        total = {total.x + n.x, total.y + n.y, total.z + n.z};
        area += std::sqrt(dot(n, n));
        volume += dot(minus(vertices[t.vertex[0]], origin), n);
    }
    constexpr double kOpen = 1e-3;
    if (std::sqrt(dot(total, total)) > kOpen * area || volume == 0 || (volume < 0) == cavity) return ShellRepair::kNone;
    for (Triangle& t : shell) turn(t);
    return ShellRepair::kTurned;
}

}  // namespace

ShellRepair orient_shell(const std::vector<Vec3>& vertices, std::span<Triangle> shell, bool cavity) {
    if (shell.empty()) return ShellRepair::kNone;
    const EdgeGraph graph(shell);
    if (!graph.closed()) return turn_looking_closed(vertices, shell, cavity);
    bool any_turned = false;
    std::vector<uint8_t> reached(shell.size(), 0);
    std::vector<uint32_t> piece;
    for (uint32_t seed = 0; seed < shell.size(); ++seed) {
        if (reached[seed] != 0) continue;
        piece.assign(1, seed);
        reached[seed] = 1;
        // `turned` of a triangle is settled when it is reached; agreement was noted before anything was turned.
        std::vector<std::pair<uint32_t, bool>> open = {{seed, false}};
        while (!open.empty()) {
            const auto [at, turned] = open.back();
            open.pop_back();
            if (turned) turn(shell[at]);
            for (const Neighbour& next : graph.neighbours()[at]) {
                if (reached[next.triangle] != 0) continue;
                reached[next.triangle] = 1;
                piece.push_back(next.triangle);
                open.emplace_back(next.triangle, turned == next.agrees);
            }
        }
        const double volume = volume_of(vertices, shell, piece);
        if (volume == 0 || (volume < 0) == cavity) continue;
        for (const uint32_t i : piece) turn(shell[i]);
        any_turned = true;
    }
    if (!graph.consistent()) return ShellRepair::kStraightened;
    return any_turned ? ShellRepair::kTurned : ShellRepair::kNone;
}

}  // namespace citystream::tiles::city
