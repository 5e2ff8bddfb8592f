#include "codec/mesh/prism_order.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace citystream::codec::mesh {

namespace {

/// A point of a prism's outer ring.
struct Corner {
    int32_t x, y;
    uint32_t prism, point;
};

/// Two corners of different prisms, the closest first.
struct Link {
    uint64_t distance;
    uint32_t a, b;  ///< corners
    friend bool operator<(const Link& l, const Link& r) {
        return std::tie(l.distance, l.a, l.b) < std::tie(r.distance, r.a, r.b);
    }
};

class Groups {
  public:
    explicit Groups(size_t count) : parent_(count), left_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    uint32_t of(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    bool join(uint32_t a, uint32_t b) {
        a = of(a);
        b = of(b);
        if (a == b) return false;
        parent_[std::max(a, b)] = std::min(a, b);
        --left_;
        return true;
    }
    size_t left() const { return left_; }

  private:
    std::vector<uint32_t> parent_;
    size_t left_;
};

class Forest {
  public:
    explicit Forest(std::span<const Prism> prisms) : groups_(prisms.size()) {
        for (uint32_t p = 0; p < prisms.size(); ++p) {
            const auto& points = prisms[p].rings[0].points;
            for (uint32_t i = 0; i < points.size(); ++i) corners_.push_back({points[i][0], points[i][1], p, i});
        }
        active_.resize(corners_.size());
        std::iota(active_.begin(), active_.end(), 0u);
    }

    /// The tree's links.
    std::vector<Link> grow() {
        for (uint32_t shift = 0; groups_.left() > 1; ++shift) {
            sort_by_cell(shift);
            find_links(shift);
            thin_out(shift);
        }
        return std::move(tree_);
    }
    const Corner& corner(uint32_t i) const { return corners_[i]; }

  private:
    using Cell = std::array<int32_t, 2>;
    Cell cell_of(uint32_t corner, uint32_t shift) const {
        return {corners_[corner].y >> shift, corners_[corner].x >> shift};
    }

    void sort_by_cell(uint32_t shift) {
        std::sort(active_.begin(), active_.end(), [&](uint32_t a, uint32_t b) {
            const Cell p = cell_of(a, shift), q = cell_of(b, shift);
            return std::tie(p, a) < std::tie(q, b);
        });
        cells_.clear();
        for (uint32_t i = 0; i < active_.size(); ++i) {
            const Cell cell = cell_of(active_[i], shift);
            if (cells_.empty() || cells_.back().first != cell) cells_.emplace_back(cell, i);
        }
        cells_.emplace_back(Cell{}, static_cast<uint32_t>(active_.size()));
    }

    /// The active corners of a cell.
    std::span<const uint32_t> in_cell(const Cell& cell) const {
        const auto less = [](const auto& entry, const Cell& wanted) { return entry.first < wanted; };
        const auto at = std::lower_bound(cells_.begin(), cells_.end() - 1, cell, less);
        if (at == cells_.end() - 1 || at->first != cell) return {};
        return {active_.data() + at->second, active_.data() + (at + 1)->second};
    }

    void find_links(uint32_t shift) {
        std::vector<Link> links;
        for (size_t c = 0; c + 1 < cells_.size(); ++c) {
            const auto [y, x] = cells_[c].first;
            const auto here = in_cell(cells_[c].first);
            for (size_t i = 0; i < here.size(); ++i) add_links(here[i], here.subspan(i + 1), shift, links);
            for (const Cell& near : {Cell{y, x + 1}, Cell{y + 1, x - 1}, Cell{y + 1, x}, Cell{y + 1, x + 1}}) {
                const auto there = in_cell(near);
                for (const uint32_t corner : here) add_links(corner, there, shift, links);
            }
        }
        std::sort(links.begin(), links.end());
        for (const Link& link : links) {
            if (groups_.join(corners_[link.a].prism, corners_[link.b].prism)) tree_.push_back(link);
        }
    }

    void add_links(uint32_t a, std::span<const uint32_t> others, uint32_t shift, std::vector<Link>& links) {
        const Corner& p = corners_[a];
        for (const uint32_t b : others) {
            const Corner& q = corners_[b];
            if (groups_.of(p.prism) == groups_.of(q.prism)) continue;
            const auto dx = static_cast<uint64_t>(std::abs(int64_t{p.x} - q.x));
            const auto dy = static_cast<uint64_t>(std::abs(int64_t{p.y} - q.y));
            // Nearer ones are sure to have been seen; what is further waits for larger cells.
            if (std::max(dx, dy) <= uint64_t{1} << shift)
                links.push_back({dx * dx + dy * dy, std::min(a, b), std::max(a, b)});
        }
    }

    /// Of a group, one corner in each quarter of a cell stands for all in it from now on.
    void thin_out(uint32_t shift) {
        if (shift < 1) return;
        std::vector<std::pair<std::tuple<Cell, uint32_t>, uint32_t>> keyed;
        for (const uint32_t corner : active_)
            keyed.push_back({{cell_of(corner, shift - 1), groups_.of(corners_[corner].prism)}, corner});
        std::sort(keyed.begin(), keyed.end());
        active_.clear();
        for (size_t i = 0; i < keyed.size(); ++i) {
            if (i == 0 || keyed[i].first != keyed[i - 1].first) active_.push_back(keyed[i].second);
        }
    }

    std::vector<Corner> corners_;
    Groups groups_;
    std::vector<uint32_t> active_;
    std::vector<std::pair<Cell, uint32_t>> cells_;
    std::vector<Link> tree_;
};

}  // namespace

std::vector<PrismVisit> order_prisms(std::span<const Prism> prisms) {
    if (prisms.empty()) return {};
    Forest forest(prisms);
    const std::vector<Link> tree = forest.grow();
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> near(prisms.size());  // own corner, other's corner
    for (const Link& link : tree) {
        near[forest.corner(link.a).prism].emplace_back(link.a, link.b);
        near[forest.corner(link.b).prism].emplace_back(link.b, link.a);
    }
    std::vector<PrismVisit> visits = {{}};
    std::vector<std::pair<uint32_t, size_t>> path = {{0, 0}};  // visit, next link of its prism
    std::vector<bool> seen(prisms.size());
    seen[0] = true;
    while (!path.empty()) {
        auto& [visit, next] = path.back();
        const PrismVisit& from = visits[visit];
        if (next == near[from.prism].size()) {
            path.pop_back();
            continue;
        }
        const auto [own, other] = near[from.prism][next++];
        const Corner &p = forest.corner(own), &q = forest.corner(other);
        if (seen[q.prism]) continue;
        seen[q.prism] = true;
        const auto n = static_cast<uint32_t>(prisms[p.prism].rings[0].points.size());
        const auto child = static_cast<uint32_t>(visits.size());
        const uint32_t parent_point = (p.point + n - from.start) % n;
        visits[visit].children.push_back(child);
        visits.push_back({q.prism, q.point, parent_point, {}});
        path.emplace_back(child, 0);
    }
    return visits;
}

}  // namespace citystream::codec::mesh
