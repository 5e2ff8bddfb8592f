#include "tiles/radiance/receiver_lattice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <unordered_set>

#include "tiles/radiance/in_parallel.h"
#include "tiles/radiance/lattice_piece.h"
#include "tiles/radiance/standing_place.h"

namespace citystream::tiles::radiance {

namespace {

int64_t floor_divide(int64_t a, int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
}

/// An odd slab's surface joins a receiver of the even slab before or after it; so what joins a receiver is decided by
/// what is at most three slabs away from a surface that joins it.
constexpr int64_t kDecisiveSlabs = 3;

/// Parts of spacing^2: splinters that mean less to a column are not searched for a place that is not buried. Models
/// have many, and the larger surfaces that share their receivers are searched.
constexpr double kSearchedShare = 1.0 / 1024;

/// A class and a column; with a slab that, too.
struct Slab {
    uint32_t surface_class = 0;
    int64_t j = 0, i = 0;
    int64_t number = 0;
    friend auto operator<=>(const Slab&, const Slab&) = default;
    bool same_column(const Slab& other) const {
        return surface_class == other.surface_class && j == other.j && i == other.i;
    }
};

struct SlabHash {
    size_t operator()(const Slab& slab) const {
        uint64_t hash = slab.surface_class;
        for (const int64_t part : {slab.j, slab.i, slab.number}) {
            hash = (hash ^ static_cast<uint64_t>(part)) * 0x9e3779b97f4a7c15U;
            hash ^= hash >> 29;
        }
        return hash;
    }
};
using SlabSet = std::unordered_set<Slab, SlabHash>;

/// A surface near a column.
struct Candidate {
    Slab slab;
    int64_t depth = 0;
    int64_t squared_distance = 0;
    GridPoint nearest;
    double share = 0;
    uint32_t triangle = 0;
    bool own = false;
};

class Lattice {
  public:
    Lattice(const OccluderScene& scene, const LatticeOptions& options) : scene_(scene), options_(options) {}

    void add_own(std::span<const SurfaceTriangle> triangles);
    void add_around(std::span<const SurfaceTriangle> triangles);
    std::vector<Receiver> receivers();

  private:
    struct Made {
        Receiver receiver;
        int64_t slab = 0;
        bool wanted = false;  ///< by a surface of its own tile
        double share = 0;
        std::vector<const Candidate*> surface{};  ///< that share it
    };

    void add(const SurfaceTriangle& triangle, bool own);
    void add_column(const ClassTriangle& seen, uint32_t triangle, int64_t i, int64_t j, bool own);
    bool decisive(const Slab& slab) const;
    /// The order in which surfaces of one slab get receivers.
    bool before(const Candidate& a, const Candidate& b) const;
    bool shares(const Candidate& candidate, const Made& made) const;
    std::vector<Receiver> receivers_of(std::span<Candidate> column) const;
    void decide(std::span<const Candidate> slab, std::vector<Made>& made) const;
    bool joins(const Candidate& candidate, std::vector<Made>& made) const;
    std::array<double, 3> normal_of(const Candidate& candidate) const;
    Made made_of(const Candidate& candidate, const GridPoint& point) const;
    std::optional<GridPoint> free_place(const Candidate& candidate) const;
    std::optional<GridPoint> standing_place_of(const Made& made) const;

    const OccluderScene& scene_;
    const LatticeOptions& options_;
    std::vector<ClassTriangle> triangles_;
    std::vector<Candidate> candidates_;
    SlabSet decisive_;  ///< what own surfaces ask for: their slabs and those that decide about them
    /// Of the columns in decisive_, each class's: to pass over most triangles of neighbours quickly.
    struct Range {
        int64_t low_i = INT64_MAX, high_i = INT64_MIN, low_j = INT64_MAX, high_j = INT64_MIN;
    };
    std::array<Range, kReceiverClasses> ranges_;
};

void Lattice::add_own(std::span<const SurfaceTriangle> triangles) {
    ranges_.fill({INT64_MIN, INT64_MAX, INT64_MIN, INT64_MAX});
    for (const SurfaceTriangle& triangle : triangles) add(triangle, true);
    ranges_.fill({});
    for (const Candidate& candidate : candidates_) {
        Slab slab = candidate.slab;
        Range& range = ranges_[slab.surface_class];
        range.low_i = std::min(range.low_i, slab.i);
        range.high_i = std::max(range.high_i, slab.i);
        range.low_j = std::min(range.low_j, slab.j);
        range.high_j = std::max(range.high_j, slab.j);
        for (slab.number = candidate.slab.number - kDecisiveSlabs;
             slab.number <= candidate.slab.number + kDecisiveSlabs; ++slab.number) {
            decisive_.insert(slab);
        }
    }
}

void Lattice::add_around(std::span<const SurfaceTriangle> triangles) {
    for (const SurfaceTriangle& triangle : triangles) add(triangle, false);
}

void Lattice::add(const SurfaceTriangle& triangle, bool own) {
    const int64_t spacing = options_.spacing;
    for (ClassTriangle& seen : seen_along_classes(triangle)) {
        const auto& corners = seen.corners;
        const Range& range = ranges_[seen.surface_class];
        const auto [low_a, high_a] = std::minmax({corners[0][0], corners[1][0], corners[2][0]});
        const auto [low_b, high_b] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
        const auto number = static_cast<uint32_t>(triangles_.size());
        const size_t before = candidates_.size();
        for (int64_t j = std::max(floor_divide(low_b, spacing), range.low_j);
             j <= std::min(-floor_divide(-high_b, spacing), range.high_j); ++j) {
            for (int64_t i = std::max(floor_divide(low_a, spacing), range.low_i);
                 i <= std::min(-floor_divide(-high_a, spacing), range.high_i); ++i) {
                add_column(seen, number, i, j, own);
            }
        }
        if (candidates_.size() > before) triangles_.push_back(seen);
    }
}

void Lattice::add_column(const ClassTriangle& seen, uint32_t triangle, int64_t i, int64_t j, bool own) {
    const int64_t spacing = options_.spacing;
    const std::array<int64_t, 2> column_at = {i * spacing, j * spacing};
    const int64_t depth = seen.depth_at(column_at);
    const Slab slab = {seen.surface_class, j, i, floor_divide(depth, spacing)};
    if (!own && !decisive_.contains(slab)) return;
    const auto piece = LatticePiece::create(seen, column_at, spacing);
    if (!piece) return;
    candidates_.push_back({slab, depth, piece->squared_distance(), piece->nearest(), piece->share(), triangle, own});
}

bool Lattice::before(const Candidate& a, const Candidate& b) const {
    const int64_t sign = class_sign(a.slab.surface_class);
    const ClassTriangle &s = triangles_[a.triangle], &t = triangles_[b.triangle];
    const auto place = [](const GridPoint& point) { return std::tie(point.x, point.y, point.z); };
    const auto first = std::make_tuple(a.squared_distance, -sign * a.depth, s.tilt, place(a.nearest));
    const auto second = std::make_tuple(b.squared_distance, -sign * b.depth, t.tilt, place(b.nearest));
    return first != second ? first < second : s.corners < t.corners;
}

bool Lattice::shares(const Candidate& candidate, const Made& made) const {
    static const double kLeastCosine = std::cos(kShareDegrees * std::numbers::pi / 180);
    if (2 * std::abs(candidate.depth - made.receiver.depth) >= options_.spacing) return false;
    const auto a = receiver_normal(candidate.slab.surface_class, triangles_[candidate.triangle].tilt);
    const auto b = receiver_normal(made.receiver.surface_class, made.receiver.tilt);
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > kLeastCosine;
}

std::array<double, 3> Lattice::normal_of(const Candidate& candidate) const {
    return receiver_normal(candidate.slab.surface_class, triangles_[candidate.triangle].tilt);
}

std::optional<GridPoint> Lattice::free_place(const Candidate& candidate) const {
    const auto normal = normal_of(candidate);
    if (!buried(scene_, candidate.nearest, normal)) return candidate.nearest;
    const auto spacing = static_cast<double>(options_.spacing);
    if (candidate.share < kSearchedShare * spacing * spacing) return std::nullopt;
    const std::array<int64_t, 2> column_at = {candidate.slab.i * options_.spacing, candidate.slab.j * options_.spacing};
    const auto piece = LatticePiece::create(triangles_[candidate.triangle], column_at, options_.spacing);
    for (const GridPoint& point : piece->others()) {
        if (!buried(scene_, point, normal)) return point;
    }
    return std::nullopt;
}

bool Lattice::joins(const Candidate& candidate, std::vector<Made>& made) const {
    for (Made& other : made) {
        // An odd slab minds the even ones beside it, which were decided before it.
        if (std::abs(other.slab - candidate.slab.number) > std::abs(candidate.slab.number % 2)) continue;
        if (!shares(candidate, other)) continue;
        other.wanted = other.wanted || candidate.own;
        other.share += candidate.share;
        other.surface.push_back(&candidate);
        return true;
    }
    return false;
}

Lattice::Made Lattice::made_of(const Candidate& candidate, const GridPoint& point) const {
    const Slab& slab = candidate.slab;
    const auto& tilt = triangles_[candidate.triangle].tilt;
    return {{static_cast<uint8_t>(slab.surface_class), {slab.i, slab.j}, candidate.depth, tilt, point},
            slab.number,
            candidate.own,
            candidate.share,
            {&candidate}};
}

std::optional<GridPoint> Lattice::standing_place_of(const Made& made) const {
    std::vector<const ClassTriangle*> surface;
    for (const Candidate* candidate : made.surface) surface.push_back(&triangles_[candidate->triangle]);
    return standing_place(scene_, made.receiver, surface, options_.spacing);
}

void Lattice::decide(std::span<const Candidate> slab, std::vector<Made>& made) const {
    // The buried come last: a wall's part above the ground speaks for its foundation, never the other way round.
    std::vector<const Candidate*> left;
    for (const Candidate& candidate : slab) {
        if (joins(candidate, made)) continue;
        if (const auto point = free_place(candidate)) {
            made.push_back(made_of(candidate, *point));
        } else {
            left.push_back(&candidate);
        }
    }
    for (const Candidate* candidate : left) {
        if (joins(*candidate, made) || enclosed(scene_, candidate->nearest, normal_of(*candidate))) continue;
        made.push_back(made_of(*candidate, candidate->nearest));
    }
}

std::vector<Receiver> Lattice::receivers_of(std::span<Candidate> column) const {
    std::sort(column.begin(), column.end(), [this](const Candidate& a, const Candidate& b) {
        const bool odd_a = a.slab.number % 2 != 0, odd_b = b.slab.number % 2 != 0;
        if (odd_a != odd_b) return odd_b;
        return a.slab.number != b.slab.number ? a.slab.number < b.slab.number : before(a, b);
    });
    std::vector<Made> made;
    for (size_t begin = 0, end = 0; begin < column.size(); begin = end) {
        while (end < column.size() && column[end].slab.number == column[begin].slab.number) ++end;
        decide(column.subspan(begin, end - begin), made);
    }
    std::vector<Receiver> result;
    const double least = options_.least_share * static_cast<double>(options_.spacing * options_.spacing);
    for (const Made& one : made) {
        if (!one.wanted || one.share < least) continue;
        const auto point = standing_place_of(one);
        if (!point) continue;
        result.push_back(one.receiver);
        result.back().point = *point;
    }
    std::sort(result.begin(), result.end());
    return result;
}

std::vector<Receiver> Lattice::receivers() {
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.slab < b.slab; });
    std::vector<std::span<Candidate>> columns;
    for (size_t begin = 0, end = 0; begin < candidates_.size(); begin = end) {
        while (end < candidates_.size() && candidates_[end].slab.same_column(candidates_[begin].slab)) ++end;
        columns.push_back(std::span(candidates_).subspan(begin, end - begin));
    }
    std::vector<std::vector<Receiver>> of_columns(columns.size());
    in_parallel(columns.size(), options_.jobs, [&](size_t i) {
        of_columns[i] = receivers_of(columns[i]);
        return true;
    });
    std::vector<Receiver> result;
    for (const auto& column : of_columns) result.insert(result.end(), column.begin(), column.end());
    return result;
}

}  // namespace

std::array<double, 3> receiver_normal(uint32_t surface_class, const std::array<int8_t, 2>& tilt) {
    const auto [own, a, b] = class_axes(surface_class);
    std::array<double, 3> normal{};
    normal[own] = static_cast<double>(class_sign(surface_class) * kTiltOne);
    normal[a] = tilt[0];
    normal[b] = tilt[1];
    const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    return {normal[0] / length, normal[1] / length, normal[2] / length};
}

std::strong_ordering operator<=>(const Receiver& a, const Receiver& b) {
    const auto key = [](const Receiver& r) {
        return std::tuple(r.surface_class, r.column[1], r.column[0], r.depth, r.tilt, r.point.x, r.point.y, r.point.z);
    };
    return key(a) <=> key(b);
}

std::vector<Receiver> place_receivers(std::span<const SurfaceTriangle> own, std::span<const SurfaceTriangle> around,
                                      const OccluderScene& scene, const LatticeOptions& options) {
    Lattice lattice(scene, options);
    lattice.add_own(own);
    lattice.add_around(around);
    return lattice.receivers();
}

std::vector<codec::radiance::ReceiverPlace> places_of(std::span<const Receiver> receivers, const GridPoint& origin,
                                                      int64_t spacing) {
    const std::array<int64_t, 3> from = {origin.x, origin.y, origin.z};
    std::vector<codec::radiance::ReceiverPlace> places;
    places.reserve(receivers.size());
    for (const Receiver& receiver : receivers) {
        const auto [own, a, b] = class_axes(receiver.surface_class);
        places.push_back({receiver.surface_class,
                          {static_cast<int32_t>(receiver.column[0] - from[a] / spacing),
                           static_cast<int32_t>(receiver.column[1] - from[b] / spacing)},
                          static_cast<int32_t>(receiver.depth - from[own]),
                          receiver.tilt});
    }
    return places;
}

}  // namespace citystream::tiles::radiance
