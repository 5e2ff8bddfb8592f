// Codes where a new point of a mesh is, from what is known around it.
//
// Built things and grown things in one: each coordinate is first compared with the places that the region suggests
// exactly (where the apex was at the last gate of this shape, the plane of the triangle beyond the gate, completing the
// parallelogram, level with one of its corners or of the border's next points); if it is none of these, the difference
// to the expected place is coded as sign and number. That place is the learnt one (place_predictor.h), or the recalled
// one (shape_memory.h) as long as these are right. All under mixed contexts, so that a mesh in which nothing is ever
// level pays next to nothing for the question. The axis along which the triangle's plane is steepest comes last: the
// two others and the plane give it.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "codec/bits/mixed_bits.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/near_points.h"
#include "codec/mesh/place_predictor.h"
#include "codec/mesh/shape_memory.h"

namespace citystream::codec::mesh {

/// How much is known about a new point: the first three of a piece, or the apex of a gate.
enum class PointRole : uint8_t { kFirst, kSecond, kThird, kApex };

/// Bits that a number takes.
inline uint32_t size_class(uint64_t value) {
    return static_cast<uint32_t>(std::bit_width(value));
}

class PointCoder {
  public:
    /// Coordinates are 0..extent[axis].
    explicit PointCoder(const GridPoint& extent);

    /// Codes a point: an apex by what lies around its gate, others by the earlier points of the piece (a the last one,
    /// b and c the ones before). False: no point inside the extent was read.
    template <typename Coder>
    bool code(Coder& coder, PointRole role, const GatePlaces& places, GridPoint& point);
    /// Difference of the point just coded to its expected place.
    const Vector& last_error() const { return error_; }
    /// Completes the parallelogram, inside the extent.
    GridPoint parallelogram(const GatePlaces& places) const;

  private:
    static constexpr uint32_t kGuesses = 8, kMiss = kGuesses;
    static constexpr uint32_t kMostTrust = 2;
    struct Guess {
        int32_t value;
        uint32_t kind;
    };
    /// What a gate says about the point to come.
    struct Shape {
        std::array<int64_t, 3> normal{};  ///< of the triangle beyond the gate, not normalised
        Vector hint{};                    ///< parallelogram less expected place
        uint32_t reach = 0, error = 0, wide_error = 0, miss = 0, kind = 0, trust = 0;  ///< as classes
    };
    struct Outcome {
        uint32_t hit = kMiss, size = 0, sign = 0;
    };
    void prepare(PointRole role, const GatePlaces& places);
    void find_normal(const GatePlaces& places, uint32_t longest);
    void guess(uint32_t axis, uint32_t kind, int64_t value);
    void guess_axis(uint32_t ordinal, const GatePlaces& places, const GridPoint& point);
    double on_plane(const Vector& through, const GridPoint& point) const;
    void set_hit_contexts(uint32_t ordinal, const GatePlaces& places);
    void set_rest_contexts(uint32_t ordinal);
    bool trusts_recalled() const;
    void finish(const GridPoint& point);
    void note(uint32_t axis, uint32_t hit, int32_t rest);
    int32_t inside(uint32_t axis, double value) const;
    template <typename Coder>
    bool code_axis(Coder& coder, uint32_t ordinal, const GatePlaces& places, GridPoint& point);

    GridPoint extent_;
    PlacePredictor predictor_;
    ShapeMemory memory_;
    bits::MixedBits hits_;
    bits::MixedLengthNumbers<2> rests_;
    bits::MixedBits signs_;

    PointRole role_ = PointRole::kFirst;
    Vector expected_{}, learnt_{}, error_{};
    Shape shape_;
    std::optional<ShapeMemory::Recalled> recalled_;  ///< where the apex of a gate of this shape was
    uint32_t recalled_well_ = 0;                     ///< how many in a row were right, up to kMostTrust
    std::array<uint32_t, 3> axes_{};                 ///< in the order in which they are coded
    std::array<Guess, kGuesses> guesses_{};
    uint32_t guess_count_ = 0;
    std::array<Outcome, 3> latest_{}, earlier_{};  ///< by axis; of this point as far as it is known, of the one before
};

template <typename Coder>
bool PointCoder::code_axis(Coder& coder, uint32_t ordinal, const GatePlaces& places, GridPoint& point) {
    const uint32_t axis = axes_[ordinal];
    guess_axis(ordinal, places, point);
    set_hit_contexts(ordinal, places);
    uint32_t hit = kMiss;
    for (uint32_t i = 0; i < guess_count_ && hit == kMiss; ++i) {
        const Guess& g = guesses_[i];
        if (hits_.code(coder, static_cast<uint32_t>(role_) * kGuesses + g.kind, point[axis] == g.value ? 1 : 0) != 0) {
            hit = g.kind;
            point[axis] = g.value;
        }
    }
    const int32_t expected = inside(axis, expected_[axis]);
    if (hit == kMiss) {
        set_rest_contexts(ordinal);
        const int64_t rest = int64_t{point[axis]} - expected;
        const uint32_t size = rests_.code(coder, static_cast<uint32_t>(rest < 0 ? -rest : rest));
        const bool up = size == 0 || signs_.code(coder, ordinal, rest > 0 ? 1 : 0) != 0;
        const int64_t value = up ? int64_t{expected} + size : int64_t{expected} - size;
        if (value < 0 || value > extent_[axis]) return false;
        point[axis] = static_cast<int32_t>(value);
    }
    note(axis, hit, point[axis] - expected);
    return true;
}

template <typename Coder>
bool PointCoder::code(Coder& coder, PointRole role, const GatePlaces& places, GridPoint& point) {
    prepare(role, places);
    for (uint32_t ordinal = 0; ordinal < 3; ++ordinal) {
        if (!code_axis(coder, ordinal, places, point)) return false;
    }
    for (size_t k = 0; k < 3; ++k) error_[k] = point[k] - expected_[k];
    if (role == PointRole::kApex) finish(point);
    return true;
}

}  // namespace citystream::codec::mesh
