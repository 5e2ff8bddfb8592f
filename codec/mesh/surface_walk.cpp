#include "codec/mesh/surface_walk.h"

#include <cmath>

namespace citystream::codec::mesh {

namespace {

// How many values the contexts of a gate have.
constexpr uint32_t kDirections = 8, kNearness = 9, kFans = 12, kStates = 9, kQuestions = 4;
constexpr uint32_t kCrowds = 12, kShortHistory = 512, kLongHistory = 4096;

Vector difference(const GridPoint& a, const GridPoint& b) {
    return {double{1} * a[0] - b[0], double{1} * a[1] - b[1], double{1} * a[2] - b[2]};
}

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// In which of kDirections, as seen from an end of the gate with the open side up, the border goes on there.
uint32_t direction_class(double along, double up) {
    if (up <= 0) return along > 0 ? 0 : 1;
    const double length = std::sqrt(along * along + up * up);
    constexpr std::array<double, 5> kCosines = {0.85, 0.5, 0.2, -0.2, -0.6};
    uint32_t sector = 2;
    for (const double cosine : kCosines) sector += along < cosine * length ? 1 : 0;
    return sector;
}

/// A distance in eighths of the gate's reach; the last of kNearness is left for what is not there.
uint32_t nearness_class(uint32_t distance, uint32_t reach) {
    if (distance == 0) return 0;
    constexpr std::array<uint64_t, 6> kEighths = {1, 2, 4, 6, 9, 16};
    uint32_t result = 1;
    for (const uint64_t eighths : kEighths) result += uint64_t{8} * distance >= eighths * reach ? 1 : 0;
    return result;
}

/// The gate's own frame: along it, and across it away from the triangle.
struct GateFrame {
    explicit GateFrame(const GatePlaces& g) : along(difference(g.b, g.a)) {
        const Vector side = difference(g.c, g.a);
        const double square = dot(along, along), share = square > 0 ? dot(side, along) / square : 0;
        for (size_t k = 0; k < 3; ++k) up[k] = share * along[k] - side[k];
        length = std::sqrt(square);
        height = std::sqrt(dot(up, up));
    }
    /// Direction of `place` from an end; sense: 1 from a, -1 from b.
    uint32_t direction(const GridPoint& place, const GridPoint& end, double sense) const {
        if (!(height > 0 && length > 0)) return 0;
        const Vector v = difference(place, end);
        return direction_class(sense * dot(v, along) / length, dot(v, up) / height);
    }
    Vector along{}, up{};
    double length = 0, height = 0;
};

}  // namespace

SurfaceWalk::SurfaceWalk(const WalkFrame& frame)
    : frame_(frame),
      near_(frame.cell_bits),
      point_coder_(frame.extent),
      beyond_({kDirections * kDirections * kStates, kNearness * kNearness * kStates, kFans * kFans * kStates,
               kShortHistory * kStates, 6 * kStates, kLongHistory},
              kQuestions),
      known_({24}, 1),
      kind_of_known_({kShortHistory, 24}, 2),
      ranks_({2 * 3, 2 * kCrowds, kShortHistory * 2}) {}

GateVertices SurfaceWalk::vertices_of(uint32_t index) const {
    const auto& gate = border_.gate(index);
    const auto &previous = border_.gate(gate.previous), &next = border_.gate(gate.next);
    return {gate.from, gate.to, gate.opposite, previous.from, next.to, previous.opposite, next.opposite};
}

void SurfaceWalk::set_gate_contexts(uint32_t index, const GatePlaces& g) {
    const auto& gate = border_.gate(index);
    const auto &previous = border_.gate(gate.previous), &next = border_.gate(gate.next);
    const bool has_before = previous.from != gate.to, has_after = next.to != gate.from;
    const auto state = [](const MeshBorder::Gate& other, bool has) {
        return !has ? 2u : other.state == MeshBorder::GateState::kEdgeOfMesh ? 1u : 0u;
    };
    const uint32_t states = state(previous, has_before) * 3 + state(next, has_after);

    const GateFrame shape(g);
    const uint32_t at_a = has_before ? shape.direction(g.before, g.a, 1) : 0;
    const uint32_t at_b = has_after ? shape.direction(g.after, g.b, -1) : 0;

    const GridPoint whole = point_coder_.parallelogram(g);
    const uint32_t reach = std::max(distance_between(g.a, g.b), distance_between(g.a, g.c));
    const auto nearness = [&](const GridPoint& place, bool has) {
        return has ? nearness_class(distance_between(place, whole), reach) : kNearness - 1;
    };
    const uint32_t fan_a = std::min(border_.vertex(gate.from).triangles, kFans - 1);
    const uint32_t fan_b = std::min(border_.vertex(gate.to).triangles, kFans - 1);
    const uint32_t exact = presence_at(whole);
    const uint32_t longer_side = reach > distance_between(g.a, g.b) ? 1 : 0;
    beyond_.set_contexts(
        {(at_a * kDirections + at_b) * kStates + states,
         (nearness(g.before, has_before) * kNearness + nearness(g.after, has_after)) * kStates + states,
         (fan_a * kFans + fan_b) * kStates + states, history_ % kShortHistory * kStates + states,
         (exact * 2 + longer_side) * kStates + states, history_ % kLongHistory});
}

/// Whether a point is exactly there: 0 no, 1 an enclosed one, 2 one on the border.
uint32_t SurfaceWalk::presence_at(const GridPoint& place) const {
    const uint32_t there = near_.at(place);
    return there == NearPoints::kNone ? 0 : border_.enclosed(there) ? 1 : 2;
}

void SurfaceWalk::set_rank_contexts(const GridPoint& place, uint32_t kind) {
    const uint32_t crowd = std::min(size_class(found_.size()), kCrowds - 1);
    ranks_.set_contexts({kind * 3 + presence_at(place), kind * kCrowds + crowd, history_ % kShortHistory * 2 + kind});
}

void SurfaceWalk::gather(const GridPoint& place, std::span<const uint32_t> except, bool enclosed) {
    found_.clear();
    near_.each_near(place, [&](uint32_t index, uint32_t distance) {
        if (border_.enclosed(index) != enclosed) return;
        if (std::find(except.begin(), except.end(), index) != except.end()) return;
        found_.emplace_back(distance, index);
    });
}

bool SurfaceWalk::find_rank(const GridPoint& place, std::span<const uint32_t> except, uint32_t index, bool enclosed,
                            uint32_t& rank) {
    gather(place, except, enclosed);
    const auto there = std::find_if(found_.begin(), found_.end(), [=](const auto& f) { return f.second == index; });
    if (there == found_.end()) return false;
    const auto target = *there;
    rank = static_cast<uint32_t>(
        std::count_if(found_.begin(), found_.end(), [&](const auto& other) { return other < target; }));
    return true;
}

}  // namespace citystream::codec::mesh
