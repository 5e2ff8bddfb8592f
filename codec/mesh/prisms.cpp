#include "codec/mesh/prisms.h"

#include <algorithm>
#include <map>
#include <optional>
#include <span>

#include "codec/mesh/prism_parts.h"
#include "codec/mesh/ring_triangles.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = WeldedMesh::kNone;
using Indices = std::array<uint32_t, 3>;
using PointRing = std::vector<uint32_t>;

/// Twice the area that a ring goes round counter-clockwise, in two words' worth of bits.
__extension__ using Area = __int128;
Area ring_area(const WeldedMesh& mesh, const PointRing& ring) {
    Area area = 0;
    for (size_t i = 0; i < ring.size(); ++i) {
        const GridPoint &p = mesh.points[ring[i]], &q = mesh.points[ring[(i + 1) % ring.size()]];
        area += int64_t{p[0]} * q[1] - int64_t{p[1]} * q[0];
    }
    return area;
}

/// What the search may look at for each triangle, and beside: cities need a hundredth of it.
constexpr uint64_t kMostLooks = 256, kLooksBeside = 1u << 16;

class PrismFinder {
  public:
    explicit PrismFinder(const GridMesh& mesh)
        : mesh_(mesh),
          walls_(find_walls(mesh_)),
          parts_(find_level_parts(mesh_, walls_)),
          looks_left_(static_cast<int64_t>(kMostLooks * mesh.triangles.size() + kLooksBeside)) {
        for (uint32_t w = 0; w < walls_.size(); ++w) walls_by_top_.add({walls_[w].p1, walls_[w].q1}, w);
        for (uint32_t part = 0; part < parts_.size(); ++part) {
            for (const PointRing& ring : parts_[part].rings)
                for (size_t i = 0; i < ring.size(); ++i)
                    parts_by_border_.add({ring[i], ring[(i + 1) % ring.size()]}, part);
        }
        walls_by_top_.sort();
        parts_by_border_.sort();
        wall_used_.resize(walls_.size());
        part_used_.resize(parts_.size());
        taken_.resize(mesh_.triangles.size());
    }

    PrismSplit split() {
        PrismSplit split;
        for (uint32_t part = 0; part < parts_.size() && looks_left_ > 0; ++part) {
            if (!part_used_[part]) try_top(part, split.prisms);
        }
        keep_remainder(split.remainder);
        return split;
    }

  private:
    void try_top(uint32_t number, std::vector<Prism>& prisms) {
        LevelPart part = parts_[number];
        if (!put_outer_ring_first(part)) return;
        const std::optional<int32_t> base = common_base(part);
        if (!base) return;
        Prism prism;
        prism.base = *base;
        prism.top = mesh_.height(part.rings[0][0]);
        for (const PointRing& ring : part.rings) {
            Ring& points = prism.rings.emplace_back();
            for (const uint32_t p : ring) points.points.push_back({mesh_.points[p][0], mesh_.points[p][1]});
        }
        prism.top_triangles = part.ring_points;
        if (!is_ring_triangulation(prism.rings, prism.top_triangles)) return;
        take_walls(part, prism);
        take(number);
        find_floor(part, prism);
        prisms.push_back(std::move(prism));
    }

    /// Also renumbers the corners; false when the part does not look up.
    bool put_outer_ring_first(LevelPart& part) const {
        Area total = 0, most = 0;
        size_t outer = 0;
        for (size_t r = 0; r < part.rings.size(); ++r) {
            const Area area = ring_area(mesh_, part.rings[r]);
            total += area;
            if (area > most) {
                most = area;
                outer = r;
            }
        }
        if (total <= 0) return false;
        size_t before = 0;
        for (size_t r = 0; r < outer; ++r) before += part.rings[r].size();
        const size_t size = part.rings[outer].size();
        for (Indices& corners : part.ring_points) {
            for (uint32_t& corner : corners) {
                if (corner < before)
                    corner += static_cast<uint32_t>(size);
                else if (corner < before + size)
                    corner -= static_cast<uint32_t>(before);
            }
        }
        std::rotate(part.rings.begin(), part.rings.begin() + static_cast<ptrdiff_t>(outer),
                    part.rings.begin() + static_cast<ptrdiff_t>(outer) + 1);
        return true;
    }

    /// Calls visit(p, q) for the border edges in order.
    template <typename Visit>
    static void for_each_edge(const LevelPart& part, Visit visit) {
        for (const PointRing& ring : part.rings)
            for (size_t i = 0; i < ring.size(); ++i) visit(ring[i], ring[(i + 1) % ring.size()]);
    }

    std::span<const EdgeIndex::Entry> look_up(const EdgeIndex& index, Edge edge) {
        const auto found = index.find(edge);
        looks_left_ -= static_cast<int64_t>(found.size());
        return looks_left_ > 0 ? found : std::span<const EdgeIndex::Entry>();
    }

    /// A wall under a border edge, if there is one from the base that one.
    uint32_t free_wall(uint32_t p, uint32_t q, int32_t base) {
        uint32_t other = kNone;
        for (const auto& [edge, wall] : look_up(walls_by_top_, {p, q})) {
            if (wall_used_[wall]) continue;
            if (mesh_.height(walls_[wall].p0) == base) return wall;
            if (other == kNone) other = wall;
        }
        return other;
    }

    /// The base of most walls under the part's border, if at least half of its edges have any.
    std::optional<int32_t> common_base(const LevelPart& part) {
        std::map<int32_t, size_t> votes;
        size_t edges = 0, covered = 0;
        for_each_edge(part, [&](uint32_t p, uint32_t q) {
            ++edges;
            bool any = false;
            for (const auto& entry : look_up(walls_by_top_, {p, q})) {
                if (wall_used_[entry.second]) continue;
                any = true;
                ++votes[mesh_.height(walls_[entry.second].p0)];
            }
            covered += any ? 1 : 0;
        });
        const auto most = std::max_element(votes.begin(), votes.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        if (most == votes.end() || 2 * covered < edges) return std::nullopt;
        return most->first;
    }

    void take_walls(const LevelPart& part, Prism& prism) {
        for_each_edge(part, [&](uint32_t p, uint32_t q) {
            const uint32_t wall = free_wall(p, q, prism.base);
            if (wall == kNone) {
                prism.walls.push_back({WallKind::kOpen, prism.base});
                return;
            }
            prism.walls.push_back({walls_[wall].kind, mesh_.height(walls_[wall].p0)});
            wall_used_[wall] = true;
            for (const uint32_t t : walls_[wall].triangles) taken_[t] = true;
        });
    }

    void take(uint32_t part) {
        part_used_[part] = true;
        for (const uint32_t t : parts_[part].triangles) taken_[t] = true;
    }

    /// A part at the base that has the same rings, turned round.
    void find_floor(const LevelPart& top, Prism& prism) {
        const uint32_t p = mesh_.at_height(top.rings[0][0], prism.base);
        const uint32_t q = mesh_.at_height(top.rings[0][1], prism.base);
        if (p == kNone || q == kNone) return;
        for (const auto& [edge, number] : look_up(parts_by_border_, {q, p})) {
            if (part_used_[number]) continue;
            const LevelPart& floor = parts_[number];
            std::vector<uint32_t> top_point;
            if (!match_rings(top, floor, top_point)) continue;
            std::vector<Indices> turned;
            for (const Indices& t : floor.ring_points)
                turned.push_back({top_point[t[0]], top_point[t[2]], top_point[t[1]]});
            if (!is_ring_triangulation(prism.rings, turned)) continue;
            take(number);
            prism.has_floor = true;
            for (const Indices& t : turned) prism.floor_triangles.push_back({t[0], t[2], t[1]});
            return;
        }
    }

    /// How far to turn `other`, read backwards, to get `ring`; nothing when they differ.
    std::optional<size_t> turned_round(const PointRing& ring, const PointRing& other) {
        const size_t n = ring.size();
        --looks_left_;
        if (other.size() != n) return std::nullopt;
        for (size_t last = 0; last < n && looks_left_ > 0; ++last) {
            size_t i = 0;
            while (i < n && mesh_.same_place(ring[i], other[(last + n - i) % n])) ++i;
            if (i == n) return last;
            looks_left_ -= static_cast<int64_t>(i) + 1;
        }
        return std::nullopt;
    }

    /// The number of the top's ring point for each of the floor's.
    bool match_rings(const LevelPart& top, const LevelPart& floor, std::vector<uint32_t>& top_point) {
        if (top.rings.size() != floor.rings.size()) return false;
        std::vector<bool> matched(top.rings.size());
        for (const PointRing& ring : floor.rings) {
            uint32_t first = 0;
            bool found = false;
            for (size_t r = 0; r < top.rings.size() && !found; ++r) {
                const size_t n = ring.size();
                const auto last = matched[r] ? std::nullopt : turned_round(top.rings[r], ring);
                if (last) {
                    for (size_t i = 0; i < n; ++i)
                        top_point.push_back(first + static_cast<uint32_t>((*last + n - i) % n));
                    matched[r] = found = true;
                }
                first += static_cast<uint32_t>(top.rings[r].size());
            }
            if (!found) return false;
        }
        return true;
    }

    void keep_remainder(GridMesh& remainder) const {
        std::vector<uint32_t> number(mesh_.points.size(), kNone);
        for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
            if (taken_[t]) continue;
            Indices corners = mesh_.triangles[t];
            for (uint32_t& corner : corners) {
                if (number[corner] == kNone) {
                    number[corner] = static_cast<uint32_t>(remainder.points.size());
                    remainder.points.push_back(mesh_.points[corner]);
                }
                corner = number[corner];
            }
            remainder.triangles.push_back(corners);
        }
    }

    const WeldedMesh mesh_;
    const std::vector<WallQuad> walls_;
    const std::vector<LevelPart> parts_;
    EdgeIndex walls_by_top_, parts_by_border_;
    std::vector<bool> wall_used_, part_used_, taken_;
    int64_t looks_left_;
};

using GridPlace = std::array<int32_t, 2>;

/// Adds points as they are asked for, each height of a ring point once.
class PrismPoints {
  public:
    PrismPoints(const Prism& prism, GridMesh& mesh) : mesh_(mesh) {
        for (const Ring& ring : prism.rings) places_.insert(places_.end(), ring.points.begin(), ring.points.end());
    }
    uint32_t at(uint32_t place, int32_t height) {
        const auto [known, added] = numbers_.try_emplace({place, height}, static_cast<uint32_t>(mesh_.points.size()));
        if (added) mesh_.points.push_back({places_[place][0], places_[place][1], height});
        return known->second;
    }

  private:
    GridMesh& mesh_;
    std::vector<GridPlace> places_;
    std::map<std::pair<uint32_t, int32_t>, uint32_t> numbers_;
};

void add_prism(const Prism& prism, GridMesh& mesh) {
    PrismPoints points(prism, mesh);
    const auto over = [&](uint32_t place) { return points.at(place, prism.top); };
    const auto under = [&](uint32_t place) { return points.at(place, prism.base); };
    uint32_t begin = 0;
    for (const Ring& ring : prism.rings) {
        const auto n = static_cast<uint32_t>(ring.points.size());
        for (uint32_t i = 0; i < n; ++i) {
            const PrismWall& wall = prism.walls[begin + i];
            if (wall.kind == WallKind::kOpen) continue;
            const uint32_t p1 = over(begin + i), q1 = over(begin + (i + 1) % n);
            const uint32_t p0 = points.at(begin + i, wall.base), q0 = points.at(begin + (i + 1) % n, wall.base);
            const bool rising = wall.kind == WallKind::kRising;
            mesh.triangles.push_back({p0, q0, rising ? q1 : p1});
            mesh.triangles.push_back({rising ? p0 : q0, q1, p1});
        }
        begin += n;
    }
    for (const Indices& t : prism.top_triangles) mesh.triangles.push_back({over(t[0]), over(t[1]), over(t[2])});
    for (const Indices& t : prism.floor_triangles) mesh.triangles.push_back({under(t[0]), under(t[1]), under(t[2])});
}

}  // namespace

PrismSplit split_prisms(const GridMesh& mesh) {
    return PrismFinder(mesh).split();
}

GridMesh join(const PrismSplit& split) {
    GridMesh mesh = split.remainder;
    for (const Prism& prism : split.prisms) add_prism(prism, mesh);
    return mesh;
}

namespace {

template <typename Change>
void change_coordinates(Prism& prism, Change change) {
    prism.base = change(prism.base);
    prism.top = change(prism.top);
    for (PrismWall& wall : prism.walls) wall.base = change(wall.base);
    for (Ring& ring : prism.rings)
        for (GridPlace& point : ring.points) point = {change(point[0]), change(point[1])};
}

}  // namespace

Prism without_low_bits(Prism prism, uint32_t dropped) {
    change_coordinates(prism, [=](int32_t value) { return value >> dropped; });
    return prism;
}

Prism with_low_bits(Prism prism, uint32_t dropped) {
    change_coordinates(prism, [=](int32_t value) { return static_cast<int32_t>(int64_t{value} << dropped); });
    return prism;
}

}  // namespace citystream::codec::mesh
