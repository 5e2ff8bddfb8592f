#include "codec/mesh/point_coder.h"

#include <cmath>

namespace citystream::codec::mesh {

namespace {

enum GuessKind : uint32_t { kParallelogram, kPlane, kLevelA, kLevelB, kLevelC, kLevelBefore, kLevelAfter, kRecalled };

// How many values the contexts have.
constexpr uint32_t kRoles = 4, kOutcomes = 9, kSizes = 24, kFineSizes = 64, kSigns = 3, kFacings = 27, kLevels = 64;
constexpr uint32_t kAxes = 3, kPairs = kSizes / 2, kTrusts = 4;

/// Edges are shifted below 2^kEdgeBits before they are multiplied, so that a determinant fits 64 bits.
constexpr uint32_t kEdgeBits = 20;

/// A recalled place is right that is off by less than this, and by no more than half of what the learnt one is.
constexpr double kRightWithin = 2.5;

/// Sizes from 10^9 on, and what is not a number, are one class.
constexpr double kHuge = 1e9;

uint32_t size_of(double value) {
    const double size = std::abs(value);
    return size < kHuge ? std::min(size_class(static_cast<uint64_t>(2 * size)), kSizes - 1) : kSizes - 1;
}

/// Twice the binary logarithm of 1 + value, rounded down.
uint32_t fine_size_of(double value) {
    const uint64_t whole = value < kHuge ? static_cast<uint64_t>(value) + 1 : 1u << 30;
    const uint32_t bits = size_class(whole);
    const auto half = static_cast<uint32_t>(bits >= 2 ? whole >> (bits - 2) & 1 : 0);
    return std::min(2 * (bits - 1) + half, kFineSizes - 1);
}

template <typename Number>
uint32_t sign_of(Number value) {
    return value == 0 ? 0 : value > 0 ? 1 : 2;
}

}  // namespace

PointCoder::PointCoder(const GridPoint& extent)
    : extent_(extent),
      hits_({kAxes * kAxes * kOutcomes * kOutcomes, kAxes * kOutcomes * kOutcomes, kAxes * kLevels,
             kAxes * kFacings * 2, kAxes * kSizes * 2, kAxes * kSizes, kTrusts * kAxes * kOutcomes},
            kRoles * kGuesses, kAxes * 2),
      rests_({kAxes * kFineSizes + kRoles * kAxes, kAxes * kSizes, kAxes * kPairs * kPairs, kAxes * kSizes,
              kAxes * kSizes, kTrusts * kAxes * 9, kAxes * PlacePredictor::kKinds, kAxes * kFineSizes},
             kRoles * kAxes),
      signs_({kAxes * kSigns * kSigns, kAxes * kSigns * kSigns, kAxes * kFacings, kAxes * kRoles * kSigns}, kAxes) {}

int32_t PointCoder::inside(uint32_t axis, double value) const {
    if (!(value > 0)) return 0;
    return value < extent_[axis] ? static_cast<int32_t>(std::floor(value + 0.5)) : extent_[axis];
}

GridPoint PointCoder::parallelogram(const GatePlaces& g) const {
    GridPoint place{};
    for (size_t k = 0; k < 3; ++k) {
        const int64_t value = int64_t{g.a[k]} + g.b[k] - g.c[k];
        place[k] = static_cast<int32_t>(std::clamp<int64_t>(value, 0, extent_[k]));
    }
    return place;
}

void PointCoder::prepare(PointRole role, const GatePlaces& g) {
    role_ = role;
    earlier_ = latest_;
    recalled_.reset();
    shape_ = {};
    axes_ = {0, 1, 2};
    if (role != PointRole::kApex) {
        for (size_t k = 0; k < 3; ++k) expected_[k] = g.a[k];
        return;
    }
    expected_ = learnt_ = predictor_.expect(g);
    recalled_ = memory_.recall(g);
    shape_.trust = recalled_ ? 1 + recalled_well_ : 0;
    const GridPoint whole = parallelogram(g);
    const uint32_t reach = std::max(distance_between(g.a, g.b), distance_between(g.a, g.c));
    double near = 0, wide = 0;
    for (size_t k = 0; k < 3; ++k) {
        shape_.hint[k] = whole[k] - expected_[k];
        near = std::max({near, std::abs(g.error_a[k]), std::abs(g.error_b[k])});
        wide += 2 * std::abs(g.error_a[k]) + 2 * std::abs(g.error_b[k]) + std::abs(g.error_c[k]);
    }
    shape_.reach = std::min(size_class(reach), kSizes - 1);
    shape_.error = size_of(near);
    shape_.wide_error = fine_size_of(wide);
    shape_.miss = fine_size_of(4 * predictor_.expected_miss());
    shape_.kind = predictor_.kind();
    find_normal(g, std::max(reach, distance_between(g.b, g.c)));
}

void PointCoder::find_normal(const GatePlaces& g, uint32_t longest) {
    const uint32_t bits = size_class(longest), shift = bits > kEdgeBits ? bits - kEdgeBits : 0;
    std::array<int64_t, 3> u{}, v{};
    for (size_t k = 0; k < 3; ++k) {
        u[k] = (int64_t{g.b[k]} - g.a[k]) >> shift;
        v[k] = (int64_t{g.c[k]} - g.a[k]) >> shift;
    }
    auto& normal = shape_.normal;
    for (size_t k = 0; k < 3; ++k) normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    std::stable_sort(axes_.begin(), axes_.end(),
                     [&](uint32_t i, uint32_t j) { return std::abs(normal[i]) < std::abs(normal[j]); });
}

void PointCoder::guess(uint32_t axis, uint32_t kind, int64_t value) {
    if (value < 0 || value > extent_[axis]) return;
    for (uint32_t i = 0; i < guess_count_; ++i) {
        if (guesses_[i].value == value) return;
    }
    guesses_[guess_count_++] = {static_cast<int32_t>(value), kind};
}

/// The coordinate along the last axis at which a plane through `through`, parallel to the triangle beyond the gate, has
/// the two others. That triangle has an area.
double PointCoder::on_plane(const Vector& through, const GridPoint& point) const {
    const uint32_t axis = axes_[2];
    double rise = 0;
    for (const uint32_t k : {axes_[0], axes_[1]})
        rise -= static_cast<double>(shape_.normal[k]) * (point[k] - through[k]);
    return through[axis] + rise / static_cast<double>(shape_.normal[axis]);
}

/// A place recalled for about this shape needs one more proof than one for the same shape.
bool PointCoder::trusts_recalled() const {
    return recalled_ && recalled_well_ > (recalled_->same ? 0u : 1u);
}

void PointCoder::guess_axis(uint32_t ordinal, const GatePlaces& g, const GridPoint& point) {
    const uint32_t axis = axes_[ordinal];
    guess_count_ = 0;
    if (role_ == PointRole::kApex) {
        if (ordinal == 2 && shape_.normal[axis] != 0) {
            const Vector corner = {double{1} * g.a[0], double{1} * g.a[1], double{1} * g.a[2]};
            const double plane = on_plane(corner, point);
            if (plane > -0.5 && plane < extent_[axis] + 0.5) guess(axis, kPlane, inside(axis, plane));
            expected_[axis] = on_plane(expected_, point);
        }
        if (trusts_recalled()) {
            guess(axis, kRecalled, inside(axis, recalled_->place[axis]));
            expected_[axis] = recalled_->place[axis];
        }
        guess(axis, kParallelogram, int64_t{g.a[axis]} + g.b[axis] - g.c[axis]);
    }
    if (role_ == PointRole::kFirst) return;
    guess(axis, kLevelA, g.a[axis]);
    if (role_ == PointRole::kSecond) return;
    guess(axis, kLevelB, g.b[axis]);
    if (role_ == PointRole::kThird) return;
    guess(axis, kLevelC, g.c[axis]);
    guess(axis, kLevelBefore, g.before[axis]);
    guess(axis, kLevelAfter, g.after[axis]);
    if (recalled_ && recalled_->same) guess(axis, kRecalled, inside(axis, recalled_->place[axis]));
}

void PointCoder::set_hit_contexts(uint32_t ordinal, const GatePlaces& g) {
    const uint32_t axis = axes_[ordinal];
    const uint32_t first = ordinal > 0 ? latest_[axes_[0]].hit : kMiss;
    const uint32_t second = ordinal > 1 ? latest_[axes_[1]].hit : kMiss;
    const uint32_t last = ordinal > 0 ? latest_[axes_[ordinal - 1]].hit : earlier_[2].hit;
    uint32_t level = 0, facing = 0;
    for (size_t k = 0; k < 3; ++k) {
        level += (g.a[k] == g.b[k] ? 1u : 0u) << (2 * k);
        level += (g.a[k] == g.c[k] || g.b[k] == g.c[k] ? 2u : 0u) << (2 * k);
        facing = 3 * facing + sign_of(shape_.normal[k]);
    }
    hits_.set_contexts({((ordinal * kAxes + axis) * kOutcomes + first) * kOutcomes + second,
                        (axis * kOutcomes + earlier_[axis].hit) * kOutcomes + last, axis * kLevels + level,
                        (axis * kFacings + facing) * 2 + (ordinal == 2 ? 1 : 0),
                        (ordinal * kSizes + shape_.error) * 2 + (axis == 2 ? 1 : 0), ordinal * kSizes + shape_.reach,
                        (shape_.trust * kAxes + ordinal) * kOutcomes + last},
                       ordinal * 2 + (shape_.trust > 1 ? 1 : 0));
}

void PointCoder::set_rest_contexts(uint32_t ordinal) {
    const uint32_t axis = axes_[ordinal], role = static_cast<uint32_t>(role_);
    const bool is_apex = role_ == PointRole::kApex;
    const Outcome none{}, first = ordinal > 0 ? latest_[axes_[0]] : none;
    const Outcome second = ordinal > 1 ? latest_[axes_[1]] : none;
    uint32_t missed = 0;
    for (uint32_t i = 0; i < ordinal; ++i) missed = 3 * missed + (latest_[axes_[i]].hit == kMiss ? 1 : 2);
    rests_.set_contexts(
        {is_apex ? kRoles * kAxes + ordinal * kFineSizes + shape_.wide_error : role * kAxes + ordinal,
         ordinal * kSizes + shape_.reach, (ordinal * kPairs + first.size / 2) * kPairs + second.size / 2,
         ordinal * kSizes + size_of(shape_.hint[axis]), axis * kSizes + earlier_[axis].size,
         (shape_.trust * kAxes + axis) * 9 + missed, ordinal * PlacePredictor::kKinds + shape_.kind,
         ordinal * kFineSizes + shape_.miss},
        role * kAxes + ordinal);
    uint32_t facing = 0;
    for (const uint32_t k : axes_) facing = 3 * facing + sign_of(shape_.normal[k]);
    const uint32_t hint = sign_of(shape_.hint[axis]);
    signs_.set_contexts({(axis * kSigns + hint) * kSigns + earlier_[axis].sign,
                         (ordinal * kSigns + first.sign) * kSigns + second.sign, ordinal * kFacings + facing,
                         (axis * kRoles + role) * kSigns + hint});
}

void PointCoder::finish(const GridPoint& point) {
    predictor_.learn(point);
    memory_.remember(point);
    if (!recalled_) return;
    double off = 0, learnt_off = 0;
    bool right = true;
    for (size_t k = 0; k < 3; ++k) {
        const double miss = std::abs(point[k] - recalled_->place[k]);
        right = right && miss < kRightWithin;
        off += miss;
        learnt_off += std::abs(point[k] - learnt_[k]);
    }
    right = right && 2 * off <= learnt_off;
    recalled_well_ = right ? std::min(recalled_well_ + 1, kMostTrust) : 0;
}

void PointCoder::note(uint32_t axis, uint32_t hit, int32_t rest) {
    latest_[axis] = {hit, std::min(size_class(static_cast<uint32_t>(std::abs(rest))), kSizes - 1), sign_of(rest)};
}

}  // namespace citystream::codec::mesh
