#include "codec/mesh/footprint_code.h"

#include <algorithm>
#include <bit>

namespace citystream::codec::mesh {

namespace {

constexpr int64_t kCoordinateLimit = int64_t{1} << 30;

uint32_t log_class(int64_t value) {
    return static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(std::abs(value))));
}
uint32_t at_most(uint32_t value, uint32_t most) {
    return std::min(value, most);
}
/// 0: negative, 1: none, 2: positive.
uint32_t side_of(int64_t value) {
    return value < 0 ? 0 : value == 0 ? 1 : 2;
}
/// A small difference as 1..7; 0 is left for "none".
uint32_t near_class(int64_t difference) {
    return 1 + static_cast<uint32_t>(std::clamp<int64_t>(difference + 3, 0, 6));
}
bool on_grid(PlaneVector p) {
    return std::abs(p.x) < kCoordinateLimit && std::abs(p.y) < kCoordinateLimit;
}
std::array<int32_t, 2> point_at(PlaneVector p) {
    return {static_cast<int32_t>(p.x), static_cast<int32_t>(p.y)};
}

/// Turns in the order in which they are likely: left, right, on, back.
constexpr uint32_t kTurnOfRank[4] = {1, 3, 0, 2}, kRankOfTurn[4] = {2, 0, 3, 1};
constexpr uint32_t kMostSizeNode = 40, kMostPointNode = 20, kSizes = 12;
constexpr size_t kMostNeighbours = 3;

}  // namespace

/// What is known of a ring when the edge to point i is told.
struct FootprintCode::Walk {
    uint32_t size = 0, i = 1;
    uint32_t quarter = 0;  ///< of the edge before, or where there is none, of the parent's
    uint32_t start_side = 0;
    uint32_t turns = 0;   ///< two bits each, the last one lowest
    int32_t winding = 0;  ///< left turns less right turns
    int64_t last_length = 0, length_before = 0;
    bool shared = false;  ///< the edge before lies on a ring told before
    uint32_t last_off = 0,
             most_off = 0;  ///< classes of how far edges were off the frame
    PlaneVector home;       ///< to the start
    PlaneVector opposite;   ///< the edge that would make a parallelogram of four points

    void take(uint32_t turn) {
        turns = turns * 4 + turn;
        if (!first()) winding += turn == 1 ? 1 : turn == 3 ? -1 : 0;
        quarter = (quarter + turn) & 3;
    }
    uint32_t left() const { return size - i; }
    bool first() const { return i == 1; }
    bool last() const { return i + 1 == size && size > 3; }
    bool of_four() const { return last() && size == 4; }
};

FootprintCode::FootprintCode()
    : size_({2, 36, kMostSizeNode * kSizes}, kMostSizeNode),
      parent_point_({kMostPointNode, kMostPointNode * 8, kMostPointNode * kMostPointNode}, kMostPointNode),
      turn_({3 * 64, 8 * 8 * 4, 16 * 16, 6 * 16, 9 * 4}, 3),
      start_along_({4, 8, 2}),
      start_across_({9, 4 * 9, 10}),
      hole_start_({2}),
      length_({12, 4 * 13, 13 * 13, 16 * 4, 40, 6 * 6}),
      last_length_({8, 6 * 6, 12, 20, 16 * 4, 8 * 6, 8 * 8}),
      off_({4 * 12, 12 * 6, 6 * 6, 13, 6 * 4, 6 * 12, 8 * 6 * 3, 8 * 8, 8 * 6 * 4}) {}

template <typename Coder>
bool FootprintCode::code(Coder& coder, Footprint& footprint, const Footprint* parent, uint32_t parent_point,
                         uint32_t most_points) {
    const auto wanted = static_cast<uint32_t>(footprint.rings.size());
    const uint32_t parent_size = parent != nullptr ? static_cast<uint32_t>(parent->rings[0].points.size()) : 0;
    footprint.frame = parent != nullptr ? parent->frame : FootprintFrame();
    uint32_t points = 0;
    for (uint32_t r = 0; r == 0 || coder.bit(more_rings_[r > 1 ? 1 : 0], r < wanted ? 1 : 0) != 0; ++r) {
        if (Coder::kDecodes) footprint.rings.emplace_back();
        auto& ring = footprint.rings[r].points;
        const uint32_t size = code_size(coder, static_cast<uint32_t>(ring.size()), parent_size, most_points - points);
        points += size;
        if (size == 0) return false;
        ring.resize(size);
        PlaneVector start = PlaneVector::of(ring[0]);
        if (r > 0) {
            const PlaneVector from = PlaneVector::of(footprint.rings[0].points[0]), d = start - from;
            hole_start_.set_contexts({0});
            start.x = from.x + hole_start_.code(coder, d.x);
            hole_start_.set_contexts({1});
            start.y = from.y + hole_start_.code(coder, d.y);
        } else if (parent != nullptr) {
            start = code_start(coder, start, *parent, code_parent_point(coder, parent_size, parent_point));
        } else {
            start.x = static_cast<int32_t>(coder.plain_bits(32, static_cast<uint32_t>(start.x)));
            start.y = static_cast<int32_t>(coder.plain_bits(32, static_cast<uint32_t>(start.y)));
        }
        if (!on_grid(start)) return false;
        ring[0] = point_at(start);
        if (!code_ring(coder, footprint.rings[r], r == 0, footprint.frame)) return false;
    }
    remember(footprint);
    return true;
}

/// 3.. points, or 0 when there are more than `most`.
template <typename Coder>
uint32_t FootprintCode::code_size(Coder& coder, uint32_t size, uint32_t parent_size, uint32_t most) {
    for (uint32_t n = 3; n <= most; ++n) {
        const uint32_t node = at_most(n - 3, kMostSizeNode - 2 + n % 2);
        size_.set_contexts({n % 2, n, node * kSizes + at_most(parent_size, kSizes + 2) - at_most(parent_size, 3)});
        if (size_.code(coder, node, n < size ? 1 : 0) == 0) return n;
    }
    return 0;
}

template <typename Coder>
uint32_t FootprintCode::code_parent_point(Coder& coder, uint32_t size, uint32_t point) {
    uint32_t at = 0;
    for (; at + 1 < size; ++at) {
        const uint32_t node = at_most(at, kMostPointNode - 1);
        parent_point_.set_contexts({node, node * 8 + at_most(size - 3, 7),
                                    node * kMostPointNode + at_most(last_parent_point_, kMostPointNode - 1)});
        if (parent_point_.code(coder, node, point > at ? 1 : 0) == 0) break;
    }
    return last_parent_point_ = at;
}

template <typename Coder>
PlaneVector FootprintCode::code_start(Coder& coder, PlaneVector start, const Footprint& parent, uint32_t parent_point) {
    const auto& points = parent.rings[0].points;
    const size_t n = points.size();
    const PlaneVector from = PlaneVector::of(points[parent_point]);
    const PlaneVector in = from - PlaneVector::of(points[(parent_point + n - 1) % n]);
    const PlaneVector out = PlaneVector::of(points[(parent_point + 1) % n]) - from;
    start_quarter_ = parent.frame.quarter_of(out);
    const uint32_t corner = (start_quarter_ - parent.frame.quarter_of(in)) & 3;
    const PlaneVector d = (start - from).turned(4 - start_quarter_);
    start_along_.set_contexts({corner, n == 4 ? corner + 4 : corner, n == 4 ? 1u : 0u});
    const int64_t along = start_along_.code(coder, d.x);
    const uint32_t reach = at_most(log_class(along), 8);
    start_across_.set_contexts({reach, corner * 9 + reach, along < 0 ? reach : 9});
    const int64_t expected = parent.frame.across(along).whole;
    const int64_t across = expected + start_across_.code(coder, d.y - expected);
    start_side_ = side_of(along) + 3 * side_of(across);
    return from + PlaneVector{along, across}.turned(start_quarter_);
}

void FootprintCode::remember(const Footprint& footprint) {
    for (const Ring& ring : footprint.rings) {
        const size_t n = ring.points.size();
        for (size_t i = 0; i < n; ++i) {
            Neighbours& at = known_[ring.points[i]];
            const auto add = [](std::vector<Point>& points, const Point& point) {
                points.insert(points.begin(), point);
                if (points.size() > kMostNeighbours) points.pop_back();
            };
            add(at.before, ring.points[(i + n - 1) % n]);
            add(at.after, ring.points[(i + 1) % n]);
        }
    }
}

template <typename Coder>
bool FootprintCode::code_shared(Coder& coder, const Walk& walk, Ring& ring) {
    Point& point = ring.points[walk.i];
    const auto ask = [&](const Point& from, const std::vector<Point> Neighbours::*side, uint32_t kind) {
        const auto at = known_.find(from);
        if (at == known_.end()) return false;
        uint32_t rank = 0;
        for (const Point& guess : at->second.*side) {
            if (coder.bit(shared_[kind][rank++], point == guess ? 1 : 0) == 0) continue;
            point = guess;
            return true;
        }
        return false;
    };
    if (ask(ring.points[walk.i - 1], &Neighbours::before, walk.first() ? 0 : walk.shared ? 1 : 2)) return true;
    return walk.i + 1 == walk.size && ask(ring.points[0], &Neighbours::after, 3);
}

template <typename Coder>
bool FootprintCode::code_ring(Coder& coder, Ring& ring, bool outer, FootprintFrame& frame) {
    auto& points = ring.points;
    Walk walk;
    walk.size = static_cast<uint32_t>(points.size());
    walk.quarter = outer ? start_quarter_ : 0;
    walk.start_side = start_side_;
    for (; walk.i < walk.size; ++walk.i) {
        walk.shared = code_shared(coder, walk, ring);
        const PlaneVector at = PlaneVector::of(points[walk.i - 1]), edge = PlaneVector::of(points[walk.i]) - at;
        walk.home = PlaneVector::of(points[0]) - at;
        if (walk.of_four()) walk.opposite = PlaneVector::of(points[0]) - PlaneVector::of(points[1]);
        const uint32_t turn = (frame.quarter_of(edge) - walk.quarter) & 3;
        walk.take(walk.shared ? turn : code_turn(coder, walk, turn, frame));
        PlaneVector told = edge.turned(4 - walk.quarter);
        if (!walk.shared) {
            told.x = code_length(coder, walk, told.x, frame);
            told.y = code_off(coder, walk, told.x, told.y, frame);
        }
        const PlaneVector to = at + told.turned(walk.quarter);
        if (!on_grid(to)) return false;
        points[walk.i] = point_at(to);
        if (walk.first() && outer)
            frame.start(told);
        else
            frame.learn(told);
        walk.length_before = walk.last_length;
        walk.last_length = std::abs(told.x);
    }
    return true;
}

template <typename Coder>
uint32_t FootprintCode::code_turn(Coder& coder, const Walk& walk, uint32_t turn, const FootprintFrame& frame) {
    const uint32_t place = at_most(walk.i - 1, 3), recent = walk.turns & 15;
    const uint32_t to_go = static_cast<uint32_t>(std::clamp(4 - walk.winding, 0, 7));
    const uint32_t home = walk.i > 2 ? (frame.quarter_of(walk.home) - walk.quarter) & 3 : 0;
    turn_.set_contexts({at_most(place, 2) * 64 + (walk.first() ? walk.start_side : walk.turns & 63),
                        (at_most(walk.left(), 7) * 8 + to_go) * 4 + home,
                        at_most(log_class(walk.last_length), 15) * 16 + recent, walk.most_off * 16 + recent,
                        at_most(walk.size, 8) * 4 + place});
    const uint32_t rank = kRankOfTurn[turn];
    uint32_t told = 0;
    while (told < 3 && turn_.code(coder, told, rank > told ? 1 : 0) != 0) ++told;
    return kTurnOfRank[told];
}

template <typename Coder>
int64_t FootprintCode::code_length(Coder& coder, const Walk& walk, int64_t length, const FootprintFrame& frame) {
    // How far it is until the start lies straight to the left or right.
    const Rounded expected = frame.along(walk.home.turned(4 - walk.quarter));
    const uint32_t recent = walk.turns & 15, longer = at_most(walk.size - 3, 3);
    const bool ahead = expected.whole > 0;
    if (walk.last()) {
        const int64_t opposite = walk.opposite.turned(4 - walk.quarter).x - expected.whole;
        last_length_.set_contexts(
            {walk.size - 4, walk.last_off * 6 + walk.most_off, at_most(log_class(expected.whole), 11),
             ahead ? 19 : at_most(log_class(expected.whole), 18), recent * 4 + at_most(walk.size - 4, 3),
             expected.part * 6 + walk.most_off, walk.of_four() ? expected.part * 8 + near_class(opposite) : 0});
        return expected.whole + last_length_.code(coder, length - expected.whole);
    }
    const uint32_t last = at_most(log_class(walk.last_length), 12), before = at_most(log_class(walk.length_before), 12);
    length_.set_contexts({longer * 3 + at_most(walk.i - 1, 2), at_most(walk.i - 1, 3) * 13 + last, last * 13 + before,
                          recent * 4 + at_most(walk.i - 1, 3), at_most(walk.left(), 7) * 5 + (ahead ? 0u : 1u),
                          walk.most_off * 6 + (ahead ? at_most(log_class(expected.whole), 5) : 0)});
    return length_.code(coder, length);
}

template <typename Coder>
int64_t FootprintCode::code_off(Coder& coder, Walk& walk, int64_t length, int64_t across, const FootprintFrame& frame) {
    const Rounded expected = frame.across(length);
    const uint32_t place = walk.first() ? 0 : walk.i == 2 ? 1 : walk.i + 1 == walk.size ? 2 : 3;
    const uint32_t size = at_most(log_class(length), 11);
    // The frame is the less sure the longer the edge is against what it was learned from.
    const uint32_t spread = at_most(log_class(8 * std::abs(length) / frame.length()), 5);
    const uint32_t four = at_most(walk.size - 3, 4);
    const int64_t opposite = walk.opposite.turned(4 - walk.quarter).y - expected.whole;
    const uint32_t parallel = walk.of_four() ? near_class(opposite) : 0;
    off_.set_contexts({place * 12 + size, size * 6 + walk.most_off, walk.last_off * 6 + walk.most_off,
                       at_most(log_class(frame.length()), 12), spread * 4 + at_most(walk.i - 1, 3), spread * 12 + size,
                       (expected.part * 6 + walk.most_off) * 3 + at_most(spread, 2), expected.part * 8 + parallel,
                       (parallel * 6 + walk.last_off) * 4 + at_most(four, 3)});
    const int64_t off = off_.code(coder, across - expected.whole);
    walk.last_off = at_most(log_class(off), 5);
    if (!walk.first()) walk.most_off = std::max(walk.most_off, walk.last_off);
    return expected.whole + off;
}

template bool FootprintCode::code(bits::RangeEncoder&, Footprint&, const Footprint*, uint32_t, uint32_t);
template bool FootprintCode::code(bits::RangeDecoder&, Footprint&, const Footprint*, uint32_t, uint32_t);

}  // namespace citystream::codec::mesh
