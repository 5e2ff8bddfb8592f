#include "codec/mesh/ring_triangles.h"

#include <algorithm>
#include <bit>

#include "codec/mesh/sweep_triangles.h"

namespace citystream::codec::mesh {

namespace {

using Indices = std::array<uint32_t, 3>;
using Loop = std::vector<uint32_t>;
using Point = std::array<int32_t, 2>;
constexpr uint32_t kNone = ~uint32_t{0};
__extension__ using Wide = __int128;

/// Loops with more points get their corners without ranks.
constexpr size_t kMostRanked = 256;

/// Triangles by their directed edges.
class ApexMap {
  public:
    explicit ApexMap(std::span<const Indices> triangles) {
        for (const Indices& t : triangles) {
            for (size_t k = 0; k < 3; ++k) entries_.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
        }
        std::sort(entries_.begin(), entries_.end());
    }
    /// The third corner of the triangle on the edge from -> to, or kNone.
    uint32_t apex(uint32_t from, uint32_t to) const {
        const auto at = std::lower_bound(entries_.begin(), entries_.end(), Indices{from, to, 0});
        return at != entries_.end() && (*at)[0] == from && (*at)[1] == to ? (*at)[2] : kNone;
    }
    bool has_double_edge() const {
        const auto same = [](const Indices& a, const Indices& b) { return a[0] == b[0] && a[1] == b[1]; };
        return std::adjacent_find(entries_.begin(), entries_.end(), same) != entries_.end();
    }

  private:
    std::vector<Indices> entries_;
};

}  // namespace

/// The rings' points in order, and the loops that are left to fill.
struct RingArea {
    std::vector<Point> points;
    std::vector<Loop> holes;  ///< not met yet
    std::vector<Loop> loops;

    explicit RingArea(std::span<const Ring> rings) {
        for (const Ring& ring : rings) {
            Loop loop;
            for (const Point& point : ring.points) {
                loop.push_back(static_cast<uint32_t>(points.size()));
                points.push_back(point);
            }
            (points.size() == loop.size() ? loops : holes).push_back(std::move(loop));
        }
    }
    Loop take_loop() {
        Loop loop = std::move(loops.back());
        loops.pop_back();
        return loop;
    }
    /// Cuts off the triangle loop[0], loop[1], loop[at].
    void cut(const Loop& loop, size_t at) {
        if (at > 2) loops.emplace_back(loop.begin() + 1, loop.begin() + static_cast<ptrdiff_t>(at) + 1);
        if (at + 1 < loop.size()) {
            loops.emplace_back(loop.begin() + static_cast<ptrdiff_t>(at), loop.end());
            loops.back().push_back(loop[0]);
        }
    }
    /// Cuts off the triangle loop[0], loop[1], holes[hole][at].
    void join(const Loop& loop, size_t hole, size_t at) {
        Loop joined(loop.begin() + 1, loop.end());
        joined.push_back(loop[0]);
        const Loop ring = std::move(holes[hole]);
        holes.erase(holes.begin() + static_cast<ptrdiff_t>(hole));
        for (size_t i = 0; i <= ring.size(); ++i) joined.push_back(ring[(at + i) % ring.size()]);
        loops.push_back(std::move(joined));
    }
};

namespace {

/// How a corner sees an edge: better ones first.
struct Sight {
    int64_t dot = 0, cross = 0;

    Sight(const Point& a, const Point& b, const Point& corner) {
        const int64_t ax = int64_t{a[0]} - corner[0], ay = int64_t{a[1]} - corner[1];
        const int64_t bx = int64_t{b[0]} - corner[0], by = int64_t{b[1]} - corner[1];
        dot = ax * bx + ay * by;
        cross = ax * by - ay * bx;
    }
    bool better_than(const Sight& other) const {
        if (cross <= 0 || other.cross <= 0) return cross > 0 && other.cross <= 0;
        return Wide{dot} * other.cross < Wide{other.dot} * cross;
    }
};

/// Places 2.. on the loop, best first.
std::vector<uint32_t> ranked_corners(std::span<const Point> points, std::span<const uint32_t> loop) {
    std::vector<Sight> sights;
    std::vector<uint32_t> order;
    for (uint32_t i = 2; i < loop.size(); ++i) {
        sights.emplace_back(points[loop[0]], points[loop[1]], points[loop[i]]);
        order.push_back(i);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return sights[a - 2].better_than(sights[b - 2]); });
    return order;
}

/// Where on the loop the third corner of the triangle on its first edge is; several places may be the same point, of
/// which the triangle's corner belongs to one.
size_t place_on_loop(const ApexMap& apexes, const Loop& loop, uint32_t corner) {
    size_t place = 0;
    for (size_t i = 2; i < loop.size(); ++i) {
        if (loop[i] != corner) continue;
        if (place == 0) {
            place = i;
            continue;
        }
        // More than one: turn from the edge that leaves this place through its triangles to the edge that enters it.
        uint32_t to = loop[(i + 1) % loop.size()];
        for (size_t steps = 0; steps < 3 * loop.size() && to != kNone && to != loop[i - 1]; ++steps) {
            if (to == loop[0]) place = i;
            to = apexes.apex(corner, to);
        }
    }
    return place;
}

/// What is chosen when the third corner is `corner`: false when no such corner is to be had.
bool find_choice(const RingArea& area, const Loop& loop, const ApexMap& apexes, uint32_t corner, size_t& hole,
                 size_t& place) {
    hole = area.holes.size();
    if (corner == kNone) return false;
    place = place_on_loop(apexes, loop, corner);
    if (place != 0) return true;
    for (hole = 0; hole < area.holes.size(); ++hole) {
        const Loop& ring = area.holes[hole];
        place = static_cast<size_t>(std::find(ring.begin(), ring.end(), corner) - ring.begin());
        if (place < ring.size()) return true;
    }
    return false;
}

/// How nearly a quadrilateral's diagonals are equally long, 1 (very) to 7; 0 for other rings.
uint32_t doubt_of(std::span<const Ring> rings) {
    if (rings.size() != 1 || rings[0].points.size() != 4) return 0;
    const auto& p = rings[0].points;
    const auto squared = [](const Point& a, const Point& b) {
        const double x = static_cast<double>(a[0]) - b[0], y = static_cast<double>(a[1]) - b[1];
        return x * x + y * y;
    };
    const double across = squared(p[0], p[2]), other = squared(p[1], p[3]), difference = across - other;
    // About 64 times the square of the difference of their lengths.
    const double doubt = across + other > 0 ? 32 * difference * difference / (across + other) : 0;
    return std::min(1u + static_cast<uint32_t>(std::bit_width(static_cast<uint32_t>(std::min(doubt, 1e6)))) / 2, 7u);
}

}  // namespace

template <typename Coder>
void RingTriangleModel::code(Coder& coder, std::span<const Ring> rings, std::vector<Indices>& triangles) {
    const ApexMap apexes(triangles), guess(sweep_triangles(rings));
    std::vector<Indices> made;
    RingArea area(rings);
    const uint32_t doubt = doubt_of(rings);
    uint32_t missed = 0;
    while (!area.loops.empty()) {
        const Loop loop = area.take_loop();
        Choice wanted{0, 0}, guessed{0, 0};
        if (!Coder::kDecodes) find_choice(area, loop, apexes, apexes.apex(loop[0], loop[1]), wanted.hole, wanted.place);
        Choice choice{area.holes.size(), 2};
        if (loop.size() > 3 || !area.holes.empty()) {
            uint32_t hit = 0;
            if (find_choice(area, loop, guess, guess.apex(loop[0], loop[1]), guessed.hole, guessed.place)) {
                const bool same = wanted.hole == guessed.hole && wanted.place == guessed.place;
                hit = coder.bit(as_guessed_[missed][doubt], same ? 1 : 0);
                missed = 1 - hit;
            }
            choice = hit != 0 ? guessed : code_unguessed(coder, area, loop, wanted);
        }
        if (choice.hole < area.holes.size()) {
            made.push_back({loop[0], loop[1], area.holes[choice.hole][choice.place]});
            area.join(loop, choice.hole, choice.place);
        } else {
            made.push_back({loop[0], loop[1], loop[choice.place]});
            area.cut(loop, choice.place);
        }
    }
    if (Coder::kDecodes) triangles = std::move(made);
}

template <typename Coder>
RingTriangleModel::Choice RingTriangleModel::code_unguessed(Coder& coder, const RingArea& area,
                                                            std::span<const uint32_t> loop, Choice wanted) {
    const auto holes = static_cast<uint32_t>(area.holes.size());
    if (holes > 0 && coder.bit(hole_[loop.size() == 3 ? 1 : 0], wanted.hole < holes ? 1 : 0) != 0) {
        const uint32_t hole = coder.uniform(holes, static_cast<uint32_t>(wanted.hole));
        const auto size = static_cast<uint32_t>(area.holes[hole].size());
        return {hole, coder.uniform(size, static_cast<uint32_t>(wanted.place))};
    }
    return {holes, loop.size() > 3 ? code_place(coder, area.points, loop, wanted.place) : 2};
}

/// The corner's place on the loop, as its rank among all.
template <typename Coder>
size_t RingTriangleModel::code_place(Coder& coder, std::span<const Point> points, std::span<const uint32_t> loop,
                                     size_t place) {
    const auto count = static_cast<uint32_t>(loop.size() - 2);
    if (loop.size() > kMostRanked) return 2 + coder.uniform(count, static_cast<uint32_t>(place - 2));
    const std::vector<uint32_t> order = ranked_corners(points, loop);
    const auto rank = static_cast<uint32_t>(std::find(order.begin(), order.end(), place) - order.begin());
    auto& models = rank_[std::min(count - 2, kSizes - 1)];
    uint32_t read = 0;
    while (read < kRanks && read + 1 < count && coder.bit(models[read], rank > read ? 1 : 0) != 0) ++read;
    if (read == kRanks) read += coder.uniform(count - read, rank - read);
    return order[read];
}

template void RingTriangleModel::code(bits::RangeEncoder&, std::span<const Ring>, std::vector<Indices>&);
template void RingTriangleModel::code(bits::RangeDecoder&, std::span<const Ring>, std::vector<Indices>&);

bool is_ring_triangulation(std::span<const Ring> rings, std::span<const Indices> triangles) {
    size_t points = 0;
    for (const Ring& ring : rings) {
        if (ring.points.size() < 3) return false;
        points += ring.points.size();
    }
    if (points > kMostRingPoints || triangles.size() != points + 2 * rings.size() - 4) return false;
    const ApexMap apexes(triangles);
    if (apexes.has_double_edge()) return false;
    RingArea area(rings);
    size_t made = 0;
    for (; !area.loops.empty(); ++made) {
        const Loop loop = area.take_loop();
        size_t hole = 0, place = 0;
        if (!find_choice(area, loop, apexes, apexes.apex(loop[0], loop[1]), hole, place)) return false;
        if (hole < area.holes.size())
            area.join(loop, hole, place);
        else
            area.cut(loop, place);
    }
    return made == triangles.size();
}

}  // namespace citystream::codec::mesh
