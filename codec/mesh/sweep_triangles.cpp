#include "codec/mesh/sweep_triangles.h"

#include <algorithm>
#include <utility>

namespace citystream::codec::mesh {

namespace {

using Indices = std::array<uint32_t, 3>;
using Point = std::array<int32_t, 2>;

class Sweep {
  public:
    explicit Sweep(std::span<const Ring> rings) {
        for (const Ring& ring : rings) {
            const auto first = static_cast<uint32_t>(points_.size()), n = static_cast<uint32_t>(ring.points.size());
            for (uint32_t i = 0; i < n; ++i) {
                points_.push_back(ring.points[i]);
                next_.push_back(first + (i + 1) % n);
                before_.push_back(first + (i + n - 1) % n);
            }
        }
    }

    std::vector<Indices> triangles() {
        cut_into_pieces();
        walk_pieces();
        return std::move(triangles_);
    }

  private:
    /// A ring edge that the line crosses, from left to right, so that the inside is above it; and the point that the
    /// line met last between it and the edge above.
    struct Active {
        uint32_t from;
        uint32_t helper;
    };

    bool left_of(uint32_t a, uint32_t b) const { return std::pair(points_[a], a) < std::pair(points_[b], b); }
    /// Twice the area of a, b, c, counter-clockwise.
    int64_t turn(uint32_t a, uint32_t b, uint32_t c) const {
        const Point &p = points_[a], &q = points_[b], &r = points_[c];
        return (int64_t{q[0]} - p[0]) * (int64_t{r[1]} - p[1]) - (int64_t{q[1]} - p[1]) * (int64_t{r[0]} - p[0]);
    }
    bool is_merge(uint32_t v) const {
        return left_of(next_[v], v) && left_of(before_[v], v) && turn(before_[v], v, next_[v]) <= 0;
    }

    void cut_into_pieces() {
        std::vector<uint32_t> order(points_.size());
        for (uint32_t v = 0; v < order.size(); ++v) order[v] = v;
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return left_of(a, b); });
        for (const uint32_t v : order) meet(v);
    }

    void meet(uint32_t v) {
        const bool ends = left_of(before_[v], v), begins = left_of(v, next_[v]);
        if (ends) end_edge(v);
        const bool convex = turn(before_[v], v, next_[v]) > 0;
        // Where the inside is below v, the edge there learns of v.
        if (!begins && (!ends || !convex)) {
            if (Active* edge = edge_below(v)) {
                cut_to_merge(v, *edge);
                edge->helper = v;
            }
        } else if (begins && !ends && !convex) {
            if (Active* edge = edge_below(v)) {
                diagonals_.emplace_back(v, edge->helper);
                edge->helper = v;
            }
        }
        if (begins) active_.push_back({v, v});
    }
    void end_edge(uint32_t v) {
        const auto edge =
            std::find_if(active_.begin(), active_.end(), [&](const Active& a) { return a.from == before_[v]; });
        if (edge == active_.end()) return;
        cut_to_merge(v, *edge);
        active_.erase(edge);
    }
    void cut_to_merge(uint32_t v, const Active& edge) {
        if (is_merge(edge.helper)) diagonals_.emplace_back(v, edge.helper);
    }
    Active* edge_below(uint32_t v) {
        Active* best = nullptr;
        double best_y = 0;
        const double x = points_[v][0], y = points_[v][1];
        for (Active& edge : active_) {
            const Point &p = points_[edge.from], &q = points_[next_[edge.from]];
            const double width = static_cast<double>(q[0]) - p[0];
            const double at = width > 0 ? p[1] + (static_cast<double>(q[1]) - p[1]) * (x - p[0]) / width : p[1];
            if (at > y || (best != nullptr && at <= best_y)) continue;
            best = &edge;
            best_y = at;
        }
        return best;
    }

    /// Directions out of point v, counter-clockwise from the right.
    bool before_around(uint32_t v, uint32_t a, uint32_t b) const {
        const auto lower = [&](uint32_t p) {
            return points_[p][1] < points_[v][1] || (points_[p][1] == points_[v][1] && points_[p][0] < points_[v][0]);
        };
        if (lower(a) != lower(b)) return lower(b);
        const int64_t area = turn(v, a, b);
        return area != 0 ? area > 0 : a < b;
    }

    void walk_pieces() {
        stars_.resize(points_.size());
        for (uint32_t v = 0; v < points_.size(); ++v) stars_[v] = {{next_[v], false}, {before_[v], true}};
        for (const auto& [a, b] : diagonals_) {
            stars_[a].push_back({b, false});
            stars_[b].push_back({a, false});
        }
        for (uint32_t v = 0; v < points_.size(); ++v)
            std::sort(stars_[v].begin(), stars_[v].end(),
                      [&](const Ray& a, const Ray& b) { return before_around(v, a.to, b.to); });
        std::vector<uint32_t> piece;
        for (uint32_t v = 0; v < points_.size(); ++v) {
            for (size_t ray = 0; ray < stars_[v].size(); ++ray) {
                if (stars_[v][ray].used) continue;
                walk_piece(v, ray, piece);
                cut_piece(piece);
            }
        }
    }
    /// Along the edges that have the piece on their left.
    void walk_piece(uint32_t v, size_t ray, std::vector<uint32_t>& piece) {
        piece.clear();
        while (!stars_[v][ray].used) {
            piece.push_back(v);
            stars_[v][ray].used = true;
            const uint32_t to = stars_[v][ray].to;
            auto& star = stars_[to];
            size_t back = 0;
            while (back + 1 < star.size() && star[back].to != v) ++back;
            ray = (back + star.size() - 1) % star.size();
            v = to;
        }
    }

    /// Triangles of a piece of which every vertical line cuts one stretch, from right to left.
    void cut_piece(const std::vector<uint32_t>& piece) {
        const size_t n = piece.size();
        if (n < 3) return;
        std::vector<uint32_t> order(n);  // places in the piece
        for (uint32_t i = 0; i < n; ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return left_of(piece[b], piece[a]); });
        // From the rightmost point counter-clockwise to the leftmost runs the upper chain.
        const auto steps = [&](uint32_t place) { return (place + n - order[0]) % n; };
        const auto upper = [&](uint32_t place) { return steps(place) < steps(order[n - 1]); };
        std::vector<uint32_t> stack = {order[0], order[1]};
        for (size_t i = 2; i + 1 < n; ++i) {
            const uint32_t place = order[i];
            if (upper(place) != upper(stack.back())) {
                for (size_t k = 0; k + 1 < stack.size(); ++k) add(piece, place, stack[k], stack[k + 1]);
                stack = {order[i - 1], place};
                continue;
            }
            while (stack.size() > 1) {
                const uint32_t b = stack.back(), c = stack[stack.size() - 2];
                const int64_t area = turn(piece[c], piece[b], piece[place]);
                if (upper(place) ? area < 0 : area > 0) break;
                add(piece, place, b, c);
                stack.pop_back();
            }
            stack.push_back(place);
        }
        for (size_t k = 0; k + 1 < stack.size(); ++k) add(piece, order[n - 1], stack[k], stack[k + 1]);
    }
    void add(const std::vector<uint32_t>& piece, uint32_t a, uint32_t b, uint32_t c) {
        Indices places = {a, b, c};
        std::sort(places.begin(), places.end());
        triangles_.push_back({piece[places[0]], piece[places[1]], piece[places[2]]});
    }

    struct Ray {
        uint32_t to;
        bool used;  ///< nothing is to be found on its left any more
    };
    std::vector<Point> points_;
    std::vector<uint32_t> next_, before_;
    std::vector<Active> active_;
    std::vector<std::pair<uint32_t, uint32_t>> diagonals_;
    std::vector<std::vector<Ray>> stars_;
    std::vector<Indices> triangles_;
};

/// Whether a quadrilateral is convex, and the shorter diagonal.
bool cut_quadrilateral(const std::vector<Point>& p, std::vector<Indices>& triangles) {
    const auto minus = [&](size_t a, size_t b) {
        return std::array<int64_t, 2>{int64_t{p[a][0]} - p[b][0], int64_t{p[a][1]} - p[b][1]};
    };
    for (size_t i = 0; i < 4; ++i) {
        const auto in = minus((i + 1) % 4, i), out = minus((i + 2) % 4, (i + 1) % 4);
        if (in[0] * out[1] - in[1] * out[0] <= 0) return false;
    }
    const auto across = minus(2, 0), other = minus(3, 1);
    if (across[0] * across[0] + across[1] * across[1] <= other[0] * other[0] + other[1] * other[1])
        triangles = {{0, 1, 2}, {0, 2, 3}};
    else
        triangles = {{0, 1, 3}, {1, 2, 3}};
    return true;
}

}  // namespace

std::vector<Indices> sweep_triangles(std::span<const Ring> rings) {
    std::vector<Indices> triangles;
    if (rings.size() == 1 && rings[0].points.size() == 4 && cut_quadrilateral(rings[0].points, triangles))
        return triangles;
    return Sweep(rings).triangles();
}

}  // namespace citystream::codec::mesh
