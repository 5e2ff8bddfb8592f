#include "codec/mesh/strips.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "codec/mesh/edge_pairs.h"

namespace citystream::codec::mesh {

namespace {

using Triangles = std::span<const std::array<uint32_t, 3>>;
constexpr uint32_t kNone = ~uint32_t{0};

/// The strips as far as they are laid, over a mesh whose half-edges are paired.
class Path {
  public:
    Path(Triangles triangles, uint32_t vertex_count)
        : triangles_(triangles), opposite_(pair_edges(triangles, vertex_count)), laid_(triangles.size(), false) {
        order_.triangles.reserve(triangles.size());
    }

    bool empty() const { return order_.triangles.empty(); }
    bool complete() const { return order_.triangles.size() == triangles_.size(); }
    bool is_laid(uint32_t triangle) const { return laid_[triangle]; }
    const StripTriangle& last() const { return order_.triangles.back(); }
    StripOrder take() { return std::move(order_); }

    /// The triangle across a half-edge, kNone if there is none that can still be laid.
    uint32_t across(uint32_t edge) const {
        const uint32_t other = opposite_[edge];
        return other == kNoEdge || laid_[other / 3] ? kNone : other / 3;
    }

    /// The half-edge by which the last triangle was entered, kNone after a restart.
    uint32_t entry() const { return entry_; }

    /// Lays the triangle across a half-edge of the last one.
    void follow(uint32_t edge) {
        StripTriangle& last = order_.triangles.back();
        // A restart may still be rotated: so that its exit is the third edge.
        if (entry_ == kNone) last.rotation = static_cast<uint8_t>(next_edge(edge) % 3);
        const bool is_previous = previous_edge(3 * last.triangle + last.rotation) == edge;
        entry_ = opposite_[edge];
        lay(entry_ / 3, entry_ % 3, is_previous ? StripStep::kPrevious : StripStep::kNext);
    }

    /// Lays a triangle that begins with a given corner; what follows may turn it.
    void restart(uint32_t corner) {
        entry_ = kNone;
        lay(corner / 3, corner % 3, StripStep::kRestart);
    }

  private:
    void lay(uint32_t triangle, uint32_t rotation, StripStep step) {
        order_.triangles.push_back({triangle, static_cast<uint8_t>(rotation), step});
        laid_[triangle] = true;
    }

    Triangles triangles_;
    std::vector<uint32_t> opposite_;
    std::vector<bool> laid_;
    uint32_t entry_ = kNone;
    StripOrder order_;
};

class BeltTraversal {
  public:
    BeltTraversal(Triangles triangles, uint32_t vertex_count)
        : triangles_(triangles),
          path_(triangles, vertex_count),
          around_(corners_around(triangles, vertex_count)),
          belt_of_(triangles.size(), kNone),
          vertex_met_(vertex_count, false) {}

    StripOrder build() {
        for (uint32_t triangle = 0; triangle < triangles_.size(); ++triangle) {
            if (belt_of_[triangle] != kNone) continue;
            std::vector<uint32_t> belt;
            add_triangles_around(triangles_[triangle][0], belt);
            for (; !belt.empty(); belt = next_belt(belt)) {
                order_belt(belt);
                ++belt_;
            }
        }
        return path_.take();
    }

  private:
    void add_triangles_around(uint32_t vertex, std::vector<uint32_t>& belt) {
        if (vertex_met_[vertex]) return;
        vertex_met_[vertex] = true;
        for (const uint32_t corner : around_.of(vertex)) {
            if (belt_of_[corner / 3] != kNone) continue;
            belt_of_[corner / 3] = belt_;
            belt.push_back(corner / 3);
        }
    }

    /// All triangles without a belt that touch a vertex of this one.
    std::vector<uint32_t> next_belt(const std::vector<uint32_t>& belt) {
        std::vector<uint32_t> next;
        for (const uint32_t triangle : belt) {
            for (const uint32_t vertex : triangles_[triangle]) add_triangles_around(vertex, next);
        }
        return next;
    }

    void order_belt(const std::vector<uint32_t>& belt) {
        waiting_.clear();
        size_t cursor = 0;
        for (size_t left = belt.size(); left > 0; --left) {
            const uint32_t edge = choose_exit();
            if (edge != kNone) {
                path_.follow(edge);
                continue;
            }
            while (!waiting_.empty() && path_.is_laid(waiting_.back())) waiting_.pop_back();
            while (path_.is_laid(belt[cursor])) ++cursor;
            path_.restart(3 * (waiting_.empty() ? belt[cursor] : waiting_.back()));
        }
    }

    uint32_t across(uint32_t edge) const {
        const uint32_t triangle = path_.across(edge);
        return triangle == kNone || belt_of_[triangle] != belt_ ? kNone : triangle;
    }

    uint32_t free_neighbours(uint32_t triangle) const {
        uint32_t count = 0;
        for (uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) count += across(edge) != kNone ? 1 : 0;
        return count;
    }

    /// The half-edge by which the strip goes on within the belt, kNone at a dead end. The neighbour with the fewest
    /// neighbours comes first, the others wait on a stack.
    uint32_t choose_exit() {
        if (path_.empty()) return kNone;
        const uint32_t last = path_.last().triangle;
        uint32_t best = kNone, fewest = kNone;
        for (uint32_t edge = 3 * last; edge < 3 * last + 3; ++edge) {
            const uint32_t neighbour = edge == path_.entry() ? kNone : across(edge);
            if (neighbour == kNone) continue;
            const uint32_t neighbours = free_neighbours(neighbour);
            if (neighbours < fewest) {
                if (best != kNone) waiting_.push_back(across(best));
                best = edge;
                fewest = neighbours;
            } else {
                waiting_.push_back(neighbour);
            }
        }
        return best;
    }

    Triangles triangles_;
    Path path_;
    VertexCorners around_;
    std::vector<uint32_t> belt_of_;  ///< kNone before a triangle has one
    std::vector<bool> vertex_met_;
    uint32_t belt_ = 0;
    std::vector<uint32_t> waiting_;
};

class PivotTraversal {
  public:
    PivotTraversal(Triangles triangles, uint32_t vertex_count, bool newest)
        : triangles_(triangles),
          path_(triangles, vertex_count),
          around_(corners_around(triangles, vertex_count)),
          cursor_(around_.begin.begin(), around_.begin.end() - 1),
          number_(vertex_count, kNone),
          newest_(newest) {}

    StripOrder build() {
        for (uint32_t seed = 0; !path_.complete(); number_corners_of_last()) {
            const uint32_t left = newest_ ? corner_left_at_newest() : corner_left_at_oldest();
            const uint32_t edge = choose_exit();
            if (edge != kNone) {
                path_.follow(edge);
            } else if (left != kNone) {
                path_.restart(first_of_fan(left));
            } else {
                while (path_.is_laid(seed)) ++seed;
                path_.restart(first_of_fan(3 * seed));
            }
        }
        return path_.take();
    }

  private:
    void number_corners_of_last() {
        for (const uint32_t vertex : strip_corners(triangles_, path_.last())) {
            if (number_[vertex] != kNone) continue;
            number_[vertex] = static_cast<uint32_t>(vertices_.size());
            vertices_.push_back(vertex);
            if (newest_) unfinished_.push_back(vertex);
        }
    }

    /// A corner at a vertex of a triangle that is not laid, kNone if there is none.
    uint32_t corner_left_at(uint32_t vertex) {
        uint32_t& cursor = cursor_[vertex];
        const uint32_t end = around_.begin[vertex + 1];
        while (cursor < end && path_.is_laid(around_.items[cursor] / 3)) ++cursor;
        return cursor < end ? around_.items[cursor] : kNone;
    }

    /// At the oldest vertex that has any. kNone: a part of the mesh is done.
    uint32_t corner_left_at_oldest() {
        for (; pivot_ < vertices_.size(); ++pivot_) {
            if (const uint32_t corner = corner_left_at(vertices_[pivot_]); corner != kNone) return corner;
        }
        return kNone;
    }

    uint32_t corner_left_at_newest() {
        for (; !unfinished_.empty(); unfinished_.pop_back()) {
            if (const uint32_t corner = corner_left_at(unfinished_.back()); corner != kNone) return corner;
        }
        return kNone;
    }

    uint32_t oldest_vertex(uint32_t triangle) const {
        const auto& [a, b, c] = triangles_[triangle];
        return std::min({number_[a], number_[b], number_[c]});
    }

    bool is_dead_end(uint32_t triangle) const {
        const uint32_t edge = 3 * triangle;
        return path_.across(edge) == kNone && path_.across(edge + 1) == kNone && path_.across(edge + 2) == kNone;
    }

    /// The half-edge to the neighbour with the oldest vertex, kNone at a dead end.
    uint32_t choose_exit() const {
        if (path_.empty()) return kNone;
        const bool rims_are_far_apart = vertices_.size() - pivot_ > kNearRims;
        const uint32_t last = path_.last().triangle;
        uint32_t best = kNone, oldest = kNone;
        for (uint32_t edge = 3 * last; edge < 3 * last + 3; ++edge) {
            const uint32_t neighbour = edge == path_.entry() ? kNone : path_.across(edge);
            if (neighbour == kNone) continue;
            const bool comes_late = rims_are_far_apart && is_dead_end(neighbour);
            const uint32_t age = comes_late ? kNone : oldest_vertex(neighbour);
            if (best != kNone && age >= oldest) continue;
            best = edge;
            oldest = age;
        }
        return best;
    }

    /// Goes around a vertex over triangles that are not laid, from a corner at it: to the last corner.
    template <typename Next>
    uint32_t end_of_fan(uint32_t corner, Next next) const {
        for (uint32_t at = corner;;) {
            const uint32_t on = next(at);
            if (on == kNone || on == corner) return on == kNone ? at : corner;
            at = on;
        }
    }

    /// The end of a corner's fan at which the strip should begin, as a corner at the same vertex: the one whose border
    /// goes to the newer vertex, so that the strip leaves the pivot towards the older one, the next pivot.
    uint32_t first_of_fan(uint32_t corner) const {
        const uint32_t pivot = triangles_[corner / 3][corner % 3];
        const auto corner_in = [&](uint32_t triangle) {
            for (uint32_t c = 3 * triangle; triangle != kNone && c < 3 * triangle + 3; ++c) {
                if (triangles_[triangle][c % 3] == pivot) return c;
            }
            return kNone;
        };
        const uint32_t one = end_of_fan(corner, [&](uint32_t at) { return corner_in(path_.across(at)); });
        const uint32_t other =
            end_of_fan(corner, [&](uint32_t at) { return corner_in(path_.across(previous_edge(at))); });
        const uint32_t one_border = triangles_[one / 3][(one + 1) % 3],
                       other_border = triangles_[other / 3][(other + 2) % 3];
        return number_[one_border] >= number_[other_border] ? one : other;
    }

    static constexpr size_t kNearRims = 32;
    Triangles triangles_;
    Path path_;
    VertexCorners around_;
    std::vector<uint32_t> cursor_;      ///< of each vertex in its corners: those before are laid
    std::vector<uint32_t> number_;      ///< by first use, kNone before
    std::vector<uint32_t> vertices_;    ///< numbered so far
    std::vector<uint32_t> unfinished_;  ///< numbered and perhaps with triangles left; the newest last
    size_t pivot_ = 0;                  ///< vertices before are finished
    bool newest_;
};

}  // namespace

StripOrder order_strips(Triangles triangles, uint32_t vertex_count, StripTraversal traversal) {
    assert(triangles.size() < uint32_t{1} << 30);
    if (traversal == StripTraversal::kBelts) return BeltTraversal(triangles, vertex_count).build();
    return PivotTraversal(triangles, vertex_count, traversal == StripTraversal::kNewestPivots).build();
}

std::vector<uint32_t> order_of_first_use(Triangles triangles, const StripOrder& order, uint32_t vertex_count) {
    std::vector<uint32_t> vertices;
    vertices.reserve(vertex_count);
    std::vector<bool> met(vertex_count, false);
    const auto meet = [&](uint32_t vertex) {
        if (!met[vertex]) vertices.push_back(vertex);
        met[vertex] = true;
    };
    for (const StripTriangle& place : order.triangles) {
        for (const uint32_t vertex : strip_corners(triangles, place)) meet(vertex);
    }
    for (uint32_t vertex = 0; vertex < vertex_count; ++vertex) meet(vertex);
    return vertices;
}

std::vector<uint32_t> inverse_order(std::span<const uint32_t> order) {
    std::vector<uint32_t> number(order.size());
    for (uint32_t i = 0; i < order.size(); ++i) number[order[i]] = i;
    return number;
}

}  // namespace citystream::codec::mesh
