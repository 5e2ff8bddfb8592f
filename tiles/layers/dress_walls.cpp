#include "tiles/layers/dress_walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace citystream::tiles::layers {
namespace {

constexpr double kGreatestSpan = 60e3 * kGridUnitsPerMetre;  // products of differences stay exact
constexpr double kGreatestMetres = 2147483648.0;
constexpr double kSteepest = 0.02;  // vertical part of an upright triangle's normal
constexpr uint32_t kNone = UINT32_MAX;

using Vec = std::array<double, 3>;

/// A triangle that may be part of a wall.
struct Candidate {
    uint32_t triangle = 0;
    std::array<uint32_t, 3> corner{};  // canonical vertices
    Vec normal{};                      // twice the area long
    double area = 0;
    std::array<uint32_t, 3> neighbour = {kNone, kNone, kNone};  // over the edge from corner[k] to corner[k + 1]
    bool taken = false;
};

Vec normal_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const auto ux = static_cast<double>(b.x - a.x), uy = static_cast<double>(b.y - a.y),
               uz = static_cast<double>(b.z - a.z);
    const auto vx = static_cast<double>(c.x - a.x), vy = static_cast<double>(c.y - a.y),
               vz = static_cast<double>(c.z - a.z);
    return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

/// A vertical plane through a line on the ground.
class WallPlane {
  public:
    WallPlane(const GridPoint& a, const GridPoint& b, const Vec& normal) : origin_(a) {
        x_ = static_cast<double>(b.x - a.x);
        y_ = static_cast<double>(b.y - a.y);
        const double length = std::hypot(x_, y_);
        x_ /= length;
        y_ /= length;
        if (y_ * normal[0] - x_ * normal[1] < 0) {
            x_ = -x_;
            y_ = -y_;
        }
    }
    double off(const GridPoint& p) const {
        return std::abs(x_ * static_cast<double>(p.y - origin_.y) - y_ * static_cast<double>(p.x - origin_.x));
    }
    double along(int64_t px, int64_t py) const {
        return x_ * static_cast<double>(px - origin_.x) + y_ * static_cast<double>(py - origin_.y);
    }
    bool faces(const Vec& normal) const { return y_ * normal[0] - x_ * normal[1] > 0; }

  private:
    GridPoint origin_;
    double x_ = 0, y_ = 0;
};

/// Finds the regions of one object.
class WallFinder {
  public:
    WallFinder(const city::CityObject& object, const GridObject& grid) : object_(object), points_(grid.points) {}

    WallSearch run() {
        unite_equal_points();
        collect_candidates();
        link_neighbours();
        std::vector<uint32_t> order(candidates_.size());
        std::iota(order.begin(), order.end(), 0U);
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t a, uint32_t b) { return candidates_[a].area > candidates_[b].area; });
        WallSearch found;
        for (uint32_t seed : order) {
            if (candidates_[seed].taken) continue;
            WallRegion region;
            if (!grow(seed, region)) continue;
            if (trace(region))
                found.walls.push_back(std::move(region));
            else
                ++found.tangled;
        }
        return found;
    }

  private:
    void unite_equal_points() {
        std::vector<uint32_t> order(points_.size());
        std::iota(order.begin(), order.end(), 0U);
        const auto key = [&](uint32_t v) { return std::array{points_[v].x, points_[v].y, points_[v].z}; };
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            const auto ka = key(a), kb = key(b);
            return ka != kb ? ka < kb : a < b;
        });
        canonical_.resize(points_.size());
        for (size_t i = 0; i < order.size(); ++i)
            canonical_[order[i]] =
                i > 0 && points_[order[i]] == points_[order[i - 1]] ? canonical_[order[i - 1]] : order[i];
    }

    void collect_candidates() {
        for (uint32_t t = 0; t < object_.triangles.size(); ++t) {
            const city::Triangle& triangle = object_.triangles[t];
            if (triangle.surface != city::SurfaceKind::kWall && triangle.surface != city::SurfaceKind::kUnknown)
                continue;
            Candidate candidate;
            candidate.triangle = t;
            for (size_t k = 0; k < 3; ++k) candidate.corner[k] = canonical_[triangle.vertex[k]];
            const Vec n =
                normal_of(points_[candidate.corner[0]], points_[candidate.corner[1]], points_[candidate.corner[2]]);
            candidate.area = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            candidate.normal = n;
            if (candidate.area > 0 && std::abs(n[2]) <= kSteepest * candidate.area) candidates_.push_back(candidate);
        }
    }

    struct HalfEdge {
        uint32_t low = 0, high = 0, candidate = 0;
        uint8_t side = 0;
        bool forward = false;
    };

    void link_neighbours() {
        std::vector<HalfEdge> edges;
        edges.reserve(candidates_.size() * 3);
        for (uint32_t c = 0; c < candidates_.size(); ++c) {
            for (uint8_t k = 0; k < 3; ++k) {
                const uint32_t a = candidates_[c].corner[k], b = candidates_[c].corner[(k + 1) % 3];
                edges.push_back({std::min(a, b), std::max(a, b), c, k, a < b});
            }
        }
        std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
            if (a.low != b.low) return a.low < b.low;
            return a.high != b.high ? a.high < b.high : a.candidate < b.candidate;
        });
        for (size_t i = 0; i < edges.size(); ++i) {
            for (size_t j = i + 1; j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high;
                 ++j) {
                if (j - i > kMostAtEdge) break;
                link(edges[i], edges[j]);
            }
        }
    }

    void link(const HalfEdge& a, const HalfEdge& b) {
        Candidate& first = candidates_[a.candidate];
        Candidate& second = candidates_[b.candidate];
        uint32_t& to_second = first.neighbour[a.side];
        uint32_t& to_first = second.neighbour[b.side];
        if (a.forward == b.forward || to_second != kNone || to_first != kNone) return;
        const Vec &n = first.normal, &m = second.normal;
        if (n[0] * m[0] + n[1] * m[1] <= 0) return;
        to_second = b.candidate;
        to_first = a.candidate;
    }

    /// The plane of a triangle by its widest side; false when its corners do not stand above one line.
    bool fits(const WallPlane& plane, const Candidate& candidate) const {
        return plane.faces(candidate.normal) &&
               std::all_of(candidate.corner.begin(), candidate.corner.end(),
                           [&](uint32_t v) { return plane.off(points_[v]) <= kFlatness; });
    }

    WallPlane plane_of(const Candidate& candidate) const {
        size_t widest = 0;
        double width = -1;
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint &a = points_[candidate.corner[k]], &b = points_[candidate.corner[(k + 1) % 3]];
            const double here = std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
            if (here > width) {
                width = here;
                widest = k;
            }
        }
        return {points_[candidate.corner[widest]], points_[candidate.corner[(widest + 1) % 3]], candidate.normal};
    }

    bool grow(uint32_t seed, WallRegion& region) {
        candidates_[seed].taken = true;
        const WallPlane plane = plane_of(candidates_[seed]);
        if (!fits(plane, candidates_[seed])) return false;
        members_ = {seed};
        for (size_t i = 0; i < members_.size(); ++i) {
            for (uint32_t next : candidates_[members_[i]].neighbour) {
                if (next == kNone || candidates_[next].taken || !fits(plane, candidates_[next])) continue;
                candidates_[next].taken = true;
                members_.push_back(next);
            }
        }
        for (uint32_t member : members_) region.triangles.push_back(candidates_[member].triangle);
        return true;
    }

    /// Outline and columns of the region in members_.
    bool trace(WallRegion& region) {
        std::vector<std::array<uint32_t, 3>> edges;  // low, high, 1 when it runs from low to high
        for (uint32_t member : members_) {
            const Candidate& candidate = candidates_[member];
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = candidate.corner[k], b = candidate.corner[(k + 1) % 3];
                edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1U : 0U});
            }
        }
        std::sort(edges.begin(), edges.end());
        std::vector<std::array<uint32_t, 2>> border;
        for (size_t i = 0; i < edges.size();) {
            size_t end = i;
            int net = 0;
            for (; end < edges.size() && edges[end][0] == edges[i][0] && edges[end][1] == edges[i][1]; ++end)
                net += edges[end][2] != 0 ? 1 : -1;
            if (end - i > 2 || (end - i == 2 && net != 0)) return false;
            if (net > 0) border.push_back({edges[i][0], edges[i][1]});
            if (net < 0) border.push_back({edges[i][1], edges[i][0]});
            i = end;
        }
        return !border.empty() && lay_out(border, region);
    }

    bool lay_out(const std::vector<std::array<uint32_t, 2>>& border, WallRegion& region) {
        const WallPlane plane = plane_of(candidates_[members_.front()]);
        for (const auto& edge : border) region.columns.push_back({points_[edge[0]].x, points_[edge[0]].y});
        const auto before = [&](const std::array<int64_t, 2>& a, const std::array<int64_t, 2>& b) {
            const double at_a = plane.along(a[0], a[1]), at_b = plane.along(b[0], b[1]);
            return at_a != at_b ? at_a < at_b : a < b;
        };
        std::sort(region.columns.begin(), region.columns.end(), before);
        region.columns.erase(std::unique(region.columns.begin(), region.columns.end()), region.columns.end());
        if (region.columns.size() < 2) return false;
        const auto& first = region.columns.front();
        const double start = plane.along(first[0], first[1]);
        for (const auto& column : region.columns)
            region.along.push_back((plane.along(column[0], column[1]) - start) * kMetresPerGridUnit);
        const auto place = [&](uint32_t v) {
            const std::array<int64_t, 2> xy = {points_[v].x, points_[v].y};
            const auto at = std::lower_bound(region.columns.begin(), region.columns.end(), xy, before);
            return WallPoint{static_cast<uint32_t>(at - region.columns.begin()), points_[v].z};
        };
        for (const auto& edge : border) region.outline.push_back({place(edge[0]), place(edge[1])});
        return true;
    }

    static constexpr size_t kMostAtEdge = 16;  // more triangles at one edge are a defect

    const city::CityObject& object_;
    const std::vector<GridPoint>& points_;
    std::vector<uint32_t> canonical_;
    std::vector<Candidate> candidates_;
    std::vector<uint32_t> members_;
};

/// z of an edge at a column between its ends.
double height_at(const WallRegion& wall, const WallEdge& edge, uint32_t column) {
    if (edge.from.column == column) return static_cast<double>(edge.from.z);
    if (edge.to.column == column) return static_cast<double>(edge.to.z);
    const double from = wall.along[edge.from.column], to = wall.along[edge.to.column];
    const double share = to == from ? 0.5 : (wall.along[column] - from) / (to - from);
    return static_cast<double>(edge.from.z) + share * static_cast<double>(edge.to.z - edge.from.z);
}

/// An edge of the outline where it crosses a strip between two columns.
struct Crossing {
    std::array<double, 2> z{};
    std::array<bool, 2> corner{};
    bool upper = false;
    double middle() const { return z[0] + z[1]; }
};

}  // namespace

city::Vec2 WallRegion::direction() const {
    const double x = static_cast<double>(columns.back()[0] - columns.front()[0]),
                 y = static_cast<double>(columns.back()[1] - columns.front()[1]);
    const double length = std::hypot(x, y);
    return {x / length, y / length};
}

bool put_on_grid(const city::CityObject& object, GridObject& out) {
    out.points.clear();
    out.points.reserve(object.vertices.size());
    GridPoint low{INT64_MAX, INT64_MAX, INT64_MAX}, high{INT64_MIN, INT64_MIN, INT64_MIN};
    for (const city::Vec3& v : object.vertices) {
        if (!(std::abs(v.x) < kGreatestMetres && std::abs(v.y) < kGreatestMetres && std::abs(v.z) < kGreatestMetres))
            return false;
        const GridPoint p{to_grid(v.x), to_grid(v.y), to_grid(v.z)};
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        out.points.push_back(p);
    }
    if (out.points.empty()) return false;
    for (const city::Triangle& triangle : object.triangles) {
        for (uint32_t v : triangle.vertex)
            if (v >= out.points.size()) return false;
    }
    out.bottom = low.z;
    out.top = high.z;
    return static_cast<double>(std::max({high.x - low.x, high.y - low.y, high.z - low.z})) < kGreatestSpan;
}

WallSearch find_walls(const city::CityObject& object, const GridObject& grid) {
    return WallFinder(object, grid).run();
}

bool slice_wall(const WallRegion& wall, std::vector<std::vector<WallSlice>>& slices) {
    constexpr size_t kMostSliceWork = 200000;
    const size_t strips = wall.columns.size() - 1;
    slices.assign(strips, {});
    if (strips * wall.outline.size() > kMostSliceWork) return false;
    std::vector<Crossing> crossings;
    for (uint32_t strip = 0; strip < strips; ++strip) {
        crossings.clear();
        for (const WallEdge& edge : wall.outline) {
            const uint32_t left = std::min(edge.from.column, edge.to.column),
                           right = std::max(edge.from.column, edge.to.column);
            if (left > strip || right < strip + 1) continue;
            crossings.push_back({{height_at(wall, edge, strip), height_at(wall, edge, strip + 1)},
                                 {left == strip, right == strip + 1},
                                 edge.from.column > edge.to.column});
        }
        std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
            return a.middle() != b.middle() ? a.middle() < b.middle() : a.upper > b.upper;
        });
        if (crossings.size() % 2 != 0) return false;
        for (size_t i = 0; i < crossings.size(); i += 2) {
            const Crossing &low = crossings[i], &high = crossings[i + 1];
            if (low.upper || !high.upper) return false;
            slices[strip].push_back({low.z, high.z, low.corner, high.corner});
        }
    }
    return true;
}

uint32_t add_column(WallRegion& wall, double metres) {
    constexpr double kSnap = 0.02;
    const auto after = std::lower_bound(wall.along.begin(), wall.along.end(), metres);
    auto index = static_cast<uint32_t>(after - wall.along.begin());
    if (after != wall.along.end() && *after - metres <= kSnap) return index;
    if (index > 0 && metres - wall.along[index - 1] <= kSnap) return index - 1;
    const double share = metres / wall.width();
    const auto &a = wall.columns.front(), &b = wall.columns.back();
    const std::array<int64_t, 2> xy = {a[0] + std::llround(share * static_cast<double>(b[0] - a[0])),
                                       a[1] + std::llround(share * static_cast<double>(b[1] - a[1]))};
    wall.columns.insert(wall.columns.begin() + index, xy);
    wall.along.insert(wall.along.begin() + index, metres);
    for (WallEdge& edge : wall.outline) {
        for (WallPoint* point : {&edge.from, &edge.to})
            if (point->column >= index) ++point->column;
    }
    return index;
}

namespace {

/// The level parts of `back` that hide `front`, when it stands on the other side of the same plane.
void hide_behind(WallRegion& front, const WallRegion& back) {
    constexpr double kTouch = 0.05;
    const city::Vec2 u = front.direction(), v = back.direction();
    if (u.x * v.x + u.y * v.y > -0.999) return;
    const auto place = [&](const std::array<int64_t, 2>& xy) {
        const double x = static_cast<double>(xy[0] - front.columns.front()[0]) * kMetresPerGridUnit,
                     y = static_cast<double>(xy[1] - front.columns.front()[1]) * kMetresPerGridUnit;
        return std::array{u.x * x + u.y * y, u.x * y - u.y * x};
    };
    const auto right = place(back.columns.front()), left = place(back.columns.back());
    if (std::max(std::abs(left[1]), std::abs(right[1])) > kTouch) return;
    if (right[0] <= kTouch || left[0] >= front.width() - kTouch) return;
    std::vector<std::vector<WallSlice>> slices;
    if (!slice_wall(back, slices)) return;
    for (size_t strip = 0; strip < slices.size(); ++strip) {
        const double to = right[0] - back.along[strip], from = right[0] - back.along[strip + 1];
        for (const WallSlice& slice : slices[strip]) {
            const auto bottom = static_cast<int64_t>(std::max(slice.bottom[0], slice.bottom[1])),
                       top = static_cast<int64_t>(std::min(slice.top[0], slice.top[1]));
            if (top > bottom && to > kTouch && from < front.width() - kTouch)
                front.hidden.push_back({std::max(from, 0.0), std::min(to, front.width()), bottom, top});
        }
    }
}

}  // namespace

void find_hidden_parts(std::span<WallRegion> walls) {
    constexpr size_t kMostPairs = 400;
    std::vector<uint32_t> order(walls.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto low = [&](uint32_t w) { return std::min(walls[w].columns.front()[0], walls[w].columns.back()[0]); };
    const auto high = [&](uint32_t w) { return std::max(walls[w].columns.front()[0], walls[w].columns.back()[0]); };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return low(a) < low(b); });
    constexpr int64_t kTouch = 52;  // grid units, 5 cm
    size_t budget = kMostPairs * walls.size();
    for (size_t i = 0; i < order.size(); ++i) {
        for (size_t j = i + 1; j < order.size() && low(order[j]) <= high(order[i]) + kTouch; ++j) {
            if (budget-- == 0) return;
            hide_behind(walls[order[i]], walls[order[j]]);
            hide_behind(walls[order[j]], walls[order[i]]);
        }
    }
}

std::vector<WallTurn> wall_turns(std::span<const WallRegion> walls) {
    constexpr size_t kMostAtCorner = 16;
    struct End {
        std::array<int64_t, 2> xy;
        uint32_t wall;
    };
    std::vector<End> lefts;
    for (uint32_t w = 0; w < walls.size(); ++w) lefts.push_back({walls[w].columns.front(), w});
    std::sort(lefts.begin(), lefts.end(),
              [](const End& a, const End& b) { return a.xy != b.xy ? a.xy < b.xy : a.wall < b.wall; });
    std::vector<WallTurn> turns(walls.size(), {std::numbers::pi, std::numbers::pi});
    for (uint32_t w = 0; w < walls.size(); ++w) {
        const std::array<int64_t, 2>& xy = walls[w].columns.back();
        const city::Vec2 u = walls[w].direction();
        auto next = std::lower_bound(lefts.begin(), lefts.end(), xy,
                                     [](const End& end, const std::array<int64_t, 2>& at) { return end.xy < at; });
        for (size_t seen = 0; next != lefts.end() && next->xy == xy && seen < kMostAtCorner; ++next, ++seen) {
            const city::Vec2 v = walls[next->wall].direction();
            const double turn = std::abs(std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y));
            turns[w].right = std::min(turns[w].right, turn);
            turns[next->wall].left = std::min(turns[next->wall].left, turn);
        }
    }
    return turns;
}

}  // namespace citystream::tiles::layers
