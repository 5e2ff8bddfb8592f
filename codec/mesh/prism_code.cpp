#include "codec/mesh/prism_code.h"

#include <algorithm>
#include <bit>
#include <memory>

#include "codec/mesh/footprint_code.h"
#include "codec/mesh/lattice_code.h"
#include "codec/mesh/prism_order.h"
#include "codec/mesh/ring_triangles.h"

namespace citystream::codec::mesh {

namespace {

using Point = std::array<int32_t, 2>;
constexpr int64_t kCoordinateLimit = int64_t{1} << 30;

/// Twice the binary logarithm, about; 0 for 0.
uint32_t half_octaves(uint64_t value) {
    const auto bits = static_cast<uint32_t>(std::bit_width(value));
    return bits < 2 ? bits : 2 * bits - 2 + static_cast<uint32_t>(value >> (bits - 2) & 1);
}

uint64_t doubled_area(const Ring& ring) {
    uint64_t area = 0;  // wraps: what is left is right but for rings that fill the whole grid
    const PlaneVector first = PlaneVector::of(ring.points[0]);
    for (size_t i = 2; i < ring.points.size(); ++i) {
        const PlaneVector a = PlaneVector::of(ring.points[i - 1]) - first, b = PlaneVector::of(ring.points[i]) - first;
        area += static_cast<uint64_t>(cross(a, b));
    }
    return static_cast<int64_t>(area) > 0 ? area : 0;
}

/// A prism told, with what those that hang on it need.
struct ToldPrism {
    Prism prism;
    Footprint footprint;  ///< in lattice numbers
    /// An encoder's: where the numbers are found, with all bits if the lattices are of these.
    std::vector<Ring> source = {};
    uint32_t height = 0;  ///< number of its height
};

/// Both directions: an encoder is given everything, a decoder fills it. Calls that return bool are false when what was
/// read makes no sense.
template <typename Coder>
class PrismCoder {
  public:
    PrismCoder(Coder& coder, const PrismLimits& limits) : coder_(coder), points_left_(limits.points) {}

    bool code_heights(std::vector<int32_t> heights);
    void code_lattices(LatticeCode lattices) {
        lattices_ = std::move(lattices);
        lattices_.code_lattices(coder_);
    }
    bool code_prism(ToldPrism& told, const ToldPrism* parent, uint32_t parent_point);
    uint32_t code_child(uint32_t children_before, size_t parent_size, size_t depth, uint32_t value) {
        const uint32_t before = std::min(children_before, 3u);
        child_.set_contexts(
            {before, static_cast<uint32_t>(std::min<size_t>(parent_size - 3, 15)), before * 2 + (depth > 1 ? 1u : 0u)});
        return child_.code(coder_, 0, value);
    }
    uint32_t code_any(uint32_t value) { return coder_.bit(any_, value); }

  private:
    bool code_off_lattice(const ToldPrism& told, Prism& prism);
    bool code_base_and_top(ToldPrism& told, const ToldPrism* parent);
    void code_walls(Prism& prism);
    void code_triangles(Prism& prism);
    uint32_t number_of(int32_t height) const {
        return static_cast<uint32_t>(std::lower_bound(heights_.begin(), heights_.end(), height) - heights_.begin());
    }
    int32_t height_of(uint32_t& number) const {
        if (number >= heights_.size()) number = static_cast<uint32_t>(heights_.size()) - 1;
        return heights_[number];
    }

    Coder& coder_;
    uint32_t points_left_;
    std::vector<int32_t> heights_;  ///< of all walls, ascending
    LatticeCode lattices_;
    FootprintCode footprint_;
    RingTriangleModel top_, floor_triangles_;
    bits::BitModel any_, floor_, wall_[3][2], own_base_[2];
    bits::MixedBits child_{{4, 16, 8}, 1};
    MixedSigned base_{2};
    bits::MixedNumbers height_{{8, 64, 28, 32 * 14}};
    bits::NumberModel wall_height_;
};

template <typename Coder>
bool PrismCoder<Coder>::code_heights(std::vector<int32_t> heights) {
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    bits::NumberModel count, step;
    const uint32_t n = count.code(coder_, static_cast<uint32_t>(heights.size()));
    if (n == 0 || n > points_left_) return false;
    int64_t last = 0;
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t more = step.code(coder_, Coder::kDecodes ? 0 : static_cast<uint32_t>(heights[i] - last));
        last += more;
        if ((more == 0 && i > 0) || last >= 2 * kCoordinateLimit) return false;
        heights_.push_back(static_cast<int32_t>(last));
    }
    return true;
}

template <typename Coder>
bool PrismCoder<Coder>::code_prism(ToldPrism& told, const ToldPrism* parent, uint32_t parent_point) {
    const uint32_t most = std::min(points_left_, kMostRingPoints);
    if (!footprint_.code(coder_, told.footprint, parent != nullptr ? &parent->footprint : nullptr, parent_point, most))
        return false;
    Prism& prism = told.prism;
    if (!code_off_lattice(told, prism) || !code_base_and_top(told, parent)) return false;
    prism.has_floor = coder_.bit(floor_, prism.has_floor ? 1 : 0) != 0;
    code_walls(prism);
    code_triangles(prism);
    points_left_ -= static_cast<uint32_t>(prism.walls.size());
    if constexpr (Coder::kDecodes) return coder_.ok();
    return true;
}

/// From lattice numbers to points.
template <typename Coder>
bool PrismCoder<Coder>::code_off_lattice(const ToldPrism& told, Prism& prism) {
    const auto& rings = told.footprint.rings;
    if (lattices_.empty()) {
        prism.rings = rings;
        return true;
    }
    prism.rings.resize(rings.size());
    for (size_t r = 0; r < rings.size(); ++r) {
        auto& points = prism.rings[r].points;
        points.resize(rings[r].points.size());
        for (size_t i = 0; i < points.size(); ++i) {
            const Point source = Coder::kDecodes ? Point{} : told.source[r].points[i];
            if (!lattices_.code_point(coder_, rings[r].points[i], source, points[i])) return false;
        }
    }
    return true;
}

template <typename Coder>
bool PrismCoder<Coder>::code_base_and_top(ToldPrism& told, const ToldPrism* parent) {
    Prism& prism = told.prism;
    const int64_t near = parent != nullptr ? parent->prism.base : 0;
    base_.set_contexts({parent != nullptr ? 1u : 0u});
    const int64_t base = near + base_.code(coder_, prism.base - near);
    const auto size = static_cast<uint32_t>(told.footprint.rings[0].points.size());
    const uint32_t area = std::min(half_octaves(doubled_area(told.footprint.rings[0])), 63u);
    // Heights are compared by their rank among 2^13.
    const uint64_t rank = parent != nullptr ? 1 + uint64_t{parent->height} * 8192 / heights_.size() : 0;
    const uint32_t near_height = std::min(half_octaves(rank), 27u);
    height_.set_contexts({std::min(size - 3, 7u), area, near_height, area / 2 * 14 + near_height / 2});
    told.height = height_.code(coder_, number_of(prism.top - prism.base));
    const int64_t top = base + height_of(told.height);
    if (std::abs(base) >= kCoordinateLimit || std::abs(top) >= kCoordinateLimit) return false;
    prism.base = static_cast<int32_t>(base);
    prism.top = static_cast<int32_t>(top);
    return true;
}

template <typename Coder>
void PrismCoder<Coder>::code_walls(Prism& prism) {
    if (Coder::kDecodes) {
        size_t points = 0;
        for (const Ring& ring : prism.rings) points += ring.points.size();
        prism.walls.resize(points);
    }
    uint32_t last = 0, last_own = 0;
    for (PrismWall& wall : prism.walls) {
        const auto kind = static_cast<uint32_t>(wall.kind);
        uint32_t told = coder_.bit(wall_[last][0], kind == 2 ? 1 : 0) != 0 ? 2 : 0;
        if (told == 0) told = coder_.bit(wall_[last][1], kind & 1);
        wall.kind = static_cast<WallKind>(told);
        last = told;
        int32_t base = prism.base;
        if (wall.kind != WallKind::kOpen) {
            last_own = coder_.bit(own_base_[last_own], wall.base != prism.base ? 1 : 0);
            if (last_own != 0) {
                uint32_t number = wall_height_.code(coder_, number_of(prism.top - wall.base));
                base = static_cast<int32_t>(
                    std::max<int64_t>(int64_t{prism.top} - height_of(number), 1 - kCoordinateLimit));
            }
        }
        wall.base = base;
    }
}

template <typename Coder>
void PrismCoder<Coder>::code_triangles(Prism& prism) {
    top_.code(coder_, prism.rings, prism.top_triangles);
    if (!prism.has_floor) return;
    const auto turn_round = [&] {
        for (auto& t : prism.floor_triangles) std::swap(t[1], t[2]);
    };
    turn_round();
    floor_triangles_.code(coder_, prism.rings, prism.floor_triangles);
    turn_round();
}

/// The prism with its outer ring begun at `start`.
Prism begun_at(const Prism& prism, uint32_t start) {
    Prism turned = prism;
    auto& points = turned.rings[0].points;
    const auto n = static_cast<uint32_t>(points.size());
    std::rotate(points.begin(), points.begin() + start, points.end());
    std::rotate(turned.walls.begin(), turned.walls.begin() + start, turned.walls.begin() + n);
    for (auto* triangles : {&turned.top_triangles, &turned.floor_triangles}) {
        for (auto& t : *triangles) {
            for (uint32_t& corner : t) corner = corner < n ? (corner + n - start) % n : corner;
        }
    }
    return turned;
}

/// Prisms in the order of the tree, and in lattice numbers.
struct Plan {
    std::vector<PrismVisit> visits;
    std::vector<Prism> prisms;  ///< with all bits
    std::vector<ToldPrism> told;
    LatticeCode lattices;
    std::vector<HiddenLattice> of_all_bits;
    std::vector<int32_t> heights;

    Plan(std::span<const Prism> given, uint32_t dropped, KnownLattices* known) : visits(order_prisms(given)) {
        for (const PrismVisit& visit : visits) {
            prisms.push_back(begun_at(given[visit.prism], visit.start));
            ToldPrism& one = told.emplace_back();
            one.prism = without_low_bits(prisms.back(), dropped);
            heights.push_back(one.prism.top - one.prism.base);
            for (const PrismWall& wall : one.prism.walls) heights.push_back(one.prism.top - wall.base);
        }
        // Lattices of all bits say the bits without the lowest, too, if they are no finer than these.
        take_numbers(prisms, dropped, known);
        of_all_bits = lattices.lattices();
        if (dropped == 0 || lattices.spacing() >= static_cast<double>(uint32_t{1} << dropped)) return;
        std::vector<Prism> coarse;
        for (const ToldPrism& one : told) coarse.push_back(one.prism);
        lattices.clear();
        take_numbers(coarse, 0, nullptr);
    }

    PrismTree tree() const {
        PrismTree tree;
        tree.parent.assign(visits.size(), PrismTree::kRoot);
        tree.lattices = of_all_bits;
        for (uint32_t v = 0; v < visits.size(); ++v) {
            tree.source.push_back(visits[v].prism);
            for (const uint32_t child : visits[v].children) tree.parent[child] = v;
        }
        return tree;
    }

  private:
    void take_numbers(const std::vector<Prism>& source, uint32_t dropped, KnownLattices* known) {
        std::vector<std::vector<Point>> rings;
        for (const Prism& prism : source)
            for (const Ring& ring : prism.rings) rings.push_back(ring.points);
        lattices.find(rings, dropped, known);
        size_t next = 0;
        for (size_t i = 0; i < told.size(); ++i) {
            told[i].source = source[i].rings;
            told[i].footprint.rings.clear();
            for (size_t r = 0; r < source[i].rings.size(); ++r)
                told[i].footprint.rings.push_back({std::move(rings[next++])});
        }
    }
};

}  // namespace

std::vector<Prism> encode_prisms(bits::RangeEncoder& encoder, std::span<const Prism> prisms, uint32_t dropped,
                                 PrismTree* tree, KnownLattices* known) {
    Plan plan(prisms, dropped, known);
    if (tree != nullptr) *tree = plan.tree();
    const auto coder = std::make_unique<PrismCoder<bits::RangeEncoder>>(encoder, PrismLimits{~0u});
    if (coder->code_any(prisms.empty() ? 0 : 1) == 0) return {};
    coder->code_heights(std::move(plan.heights));
    coder->code_lattices(std::move(plan.lattices));
    std::vector<std::pair<uint32_t, uint32_t>> path;  // visit, children told
    coder->code_prism(plan.told[0], nullptr, 0);
    path.emplace_back(0, 0);
    while (!path.empty()) {
        auto& [visit, next] = path.back();
        const auto& children = plan.visits[visit].children;
        const size_t size = plan.told[visit].footprint.rings[0].points.size();
        if (coder->code_child(next, size, path.size(), next < children.size() ? 1 : 0) == 0) {
            path.pop_back();
            continue;
        }
        const uint32_t child = children[next++];
        coder->code_prism(plan.told[child], &plan.told[visit], plan.visits[child].parent_point);
        path.emplace_back(child, 0);
    }
    return std::move(plan.prisms);
}

Result<std::vector<Prism>> decode_prisms(bits::RangeDecoder& decoder, const PrismLimits& limits, PrismTree* tree) {
    const Error senseless{"prisms make no sense", decoder.position()};
    std::vector<Prism> prisms;
    const auto coder = std::make_unique<PrismCoder<bits::RangeDecoder>>(decoder, limits);
    if (coder->code_any(0) == 0) return prisms;
    if (!coder->code_heights({})) return senseless;
    coder->code_lattices({});
    struct Open {
        ToldPrism told;
        uint32_t children, number;
    };
    std::vector<Open> path;
    for (bool more = true; more || !path.empty();) {
        if (more) {
            ToldPrism told;
            if (!coder->code_prism(told, path.empty() ? nullptr : &path.back().told, 0)) return senseless;
            if (!path.empty()) ++path.back().children;
            if (tree != nullptr) tree->parent.push_back(path.empty() ? PrismTree::kRoot : path.back().number);
            prisms.push_back(told.prism);
            told.prism = {.rings = {},
                          .base = told.prism.base,
                          .top = told.prism.top,
                          .walls = {},
                          .top_triangles = {},
                          .floor_triangles = {}};
            path.push_back({std::move(told), 0, static_cast<uint32_t>(prisms.size() - 1)});
        } else {
            path.pop_back();
            if (path.empty()) break;
        }
        const Open& open = path.back();
        more = coder->code_child(open.children, open.told.footprint.rings[0].points.size(), path.size(), 0) != 0;
    }
    return prisms;
}

Result<std::vector<Prism>> decode_prisms_within(bits::RangeDecoder& decoder, uint32_t& points, uint32_t& triangles,
                                                PrismTree* tree) {
    auto prisms = decode_prisms(decoder, {points}, tree);
    if (!prisms) return prisms;
    uint64_t taken_points = 0, taken_triangles = 0;
    for (const Prism& prism : *prisms) {
        taken_points += 2 * prism.walls.size();
        taken_triangles += 2 * prism.walls.size() + prism.top_triangles.size() + prism.floor_triangles.size();
    }
    if (taken_points > points || taken_triangles > triangles)
        return Error{"more prisms than there is room for", decoder.position()};
    points -= static_cast<uint32_t>(taken_points);
    triangles -= static_cast<uint32_t>(taken_triangles);
    return prisms;
}

}  // namespace citystream::codec::mesh
