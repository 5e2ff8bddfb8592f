#include "codec/mesh/resident_prisms.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "codec/mesh/mesh_resident_layout.h"

namespace citystream::codec::mesh {

namespace {

using Corners = std::array<uint32_t, 3>;

/// What one draw more counts for, in bits of the layer.
constexpr uint64_t kDrawBits = 32 * 32;
constexpr uint64_t kRangeBits = 32 * RESIDENT_RANGE_WORDS + kDrawBits;

/// Rings one after the other, each to its start again if there are several.
void add_loop(const Prism& prism, uint32_t dropped, PrismRecord& record) {
    size_t wall = 0;
    for (const Ring& ring : prism.rings) {
        for (const auto& point : ring.points) {
            record.points.push_back(point);
            const PrismWall& made = prism.walls[wall++];
            const bool open = made.kind == WallKind::kOpen;
            const bool own = made.base >> dropped != prism.base >> dropped;
            record.wall_bases.push_back(open ? prism.top : own ? made.base : prism.base);
            record.has_wall_bases |= open || own;
        }
        if (prism.rings.size() == 1) break;
        record.points.push_back(ring.points[0]);
        record.wall_bases.push_back(prism.top);
        record.has_wall_bases = true;
    }
}

/// The loop's number of each point of the rings.
std::vector<uint32_t> loop_numbers(const Prism& prism) {
    std::vector<uint32_t> numbers;
    uint32_t number = 0;
    for (const Ring& ring : prism.rings) {
        for (size_t i = 0; i < ring.points.size(); ++i) numbers.push_back(number++);
        number += prism.rings.size() > 1 ? 1 : 0;
    }
    return numbers;
}

/// Repeats the last point; the wall from it to the first stays the last one.
void pad_loop(PrismRecord& record, size_t points) {
    if (record.points.size() >= points) return;
    const int32_t last_wall = record.wall_bases.back();
    record.wall_bases.back() = record.base;
    record.points.resize(points, record.points.back());
    record.wall_bases.resize(points, record.base);
    record.wall_bases.back() = last_wall;
}

/// Numbers of points decide, not places: so it is the same whatever is known.
struct Kind {
    bool floors, wall_bases;
    uint32_t points;
    auto operator<=>(const Kind&) const = default;
};
using Kinds = std::map<Kind, std::vector<uint32_t>>;

uint64_t bits_of(const Kind& kind, uint32_t level) {
    return level * PrismGroup{kind.points, kind.wall_bases, kind.floors, {}}.record_words();
}

/// The least of `kinds` that could hold what `kind` does.
std::optional<Kind> next_kind(const Kinds& kinds, const Kind& kind, bool wall_bases) {
    const auto at = wall_bases == kind.wall_bases ? kinds.upper_bound(kind)
                                                  : kinds.lower_bound({kind.floors, wall_bases, kind.points});
    if (at == kinds.end() || at->first.floors != kind.floors || at->first.wall_bases != wall_bases) return std::nullopt;
    return at->first;
}

/// Joins what saves most until nothing does.
void join_kinds(Kinds& kinds, uint32_t level) {
    while (true) {
        int64_t most = 0;
        std::pair<Kind, Kind> best{};
        for (const auto& [kind, prisms] : kinds) {
            for (const bool wall_bases : {kind.wall_bases, true}) {
                const std::optional<Kind> to = next_kind(kinds, kind, wall_bases);
                if (!to) continue;
                const uint64_t cost = prisms.size() * (bits_of(*to, level) - bits_of(kind, level));
                const auto saved = static_cast<int64_t>(kRangeBits) - static_cast<int64_t>(cost);
                if (saved <= most) continue;
                most = saved;
                best = {kind, *to};
            }
        }
        if (most <= 0) return;
        std::vector<uint32_t> moved = std::move(kinds.at(best.first));
        kinds.erase(best.first);
        std::vector<uint32_t>& to = kinds.at(best.second);
        to.insert(to.end(), moved.begin(), moved.end());
        std::sort(to.begin(), to.end());
    }
}

}  // namespace

PrismRecord prism_record(const Prism& prism, uint32_t dropped, size_t points) {
    PrismRecord record;
    record.base = prism.base;
    record.top = prism.top;
    add_loop(prism, dropped, record);
    pad_loop(record, std::max(points, prism.top_triangles.size() + 2));
    const std::vector<uint32_t> numbers = loop_numbers(prism);
    for (const Corners& t : prism.top_triangles) {
        Corners turned = {numbers[t[0]], numbers[t[1]], numbers[t[2]]};
        std::rotate(turned.begin(), std::min_element(turned.begin(), turned.end()), turned.end());
        record.top_triangles.push_back(turned);
    }
    record.top_triangles.resize(record.points.size() - 2);
    std::sort(record.top_triangles.begin(), record.top_triangles.end());
    return record;
}

std::vector<PrismGroup> group_prisms(const MeshContent& content, uint32_t level) {
    Kinds kinds;
    for (uint32_t i = 0; i < content.prisms.size(); ++i) {
        const Prism& prism = content.prisms[i].shape;
        const PrismRecord record = prism_record(prism, content.dropped[0]);
        kinds[{prism.has_floor, record.has_wall_bases, static_cast<uint32_t>(record.points.size())}].push_back(i);
    }
    join_kinds(kinds, level);
    std::vector<PrismGroup> groups;
    for (auto& [kind, prisms] : kinds) groups.push_back({kind.points, kind.wall_bases, kind.floors, std::move(prisms)});
    return groups;
}

}  // namespace citystream::codec::mesh
