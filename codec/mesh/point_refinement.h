// The low bits of a mesh's points, once the higher ones are known to both sides.
//
// Points come in the order of the walk. Where a point is expected is worked out anew from points that are already
// refined and learnt anew (place_predictor.h); each further bit is coded under how far that place is from the middle of
// what is left, and what the bit would be if the point were exactly there, completed the parallelogram or were level
// with a corner of the triangle that it was met from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/mixed_bits.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/surface_walk.h"

namespace citystream::codec::mesh {

class PointRefinement {
  public:
    /// Adds `bits` (1..31) bits below what the points have.
    explicit PointRefinement(uint32_t bits);

    /// Refines points[index], where all points before it are refined and those from it on are not. The writer gives the
    /// whole point. Coordinates have to have room for the bits.
    template <typename Coder>
    void code(Coder& coder, std::span<GridPoint> points, uint32_t index, const Origin& origin,
              const GridPoint& whole = {});

  private:
    static constexpr uint32_t kGuesses = 4;
    void expect(std::span<const GridPoint> points, uint32_t index, const Origin& origin);
    void set_guesses(std::span<const GridPoint> points, uint32_t axis, uint32_t index, const GateVertices& from);
    void set_contexts(uint32_t axis, uint32_t bit, int64_t lowest);
    void learn(const GridPoint& point, const Origin& origin);

    uint32_t bits_;
    bits::MixedBits next_;
    PlacePredictor predictor_;
    std::vector<Vector> errors_;
    Vector expected_{};
    uint32_t error_class_ = 0;
    std::array<int64_t, kGuesses> guesses_{};  ///< parallelogram, then level with each corner
};

template <typename Coder>
void PointRefinement::code(Coder& coder, std::span<GridPoint> points, uint32_t index, const Origin& origin,
                           const GridPoint& whole) {
    expect(points, index, origin);
    for (uint32_t axis = 0; axis < 3; ++axis) {
        set_guesses(points, axis, index, origin.gate);
        int64_t value = int64_t{points[index][axis]} << bits_;
        for (uint32_t bit = bits_; bit-- > 0;) {
            set_contexts(axis, bit, value);
            const uint32_t one = next_.code(coder, 0, static_cast<uint32_t>(whole[axis]) >> bit & 1);
            value |= int64_t{one} << bit;
        }
        points[index][axis] = static_cast<int32_t>(value);
    }
    learn(points[index], origin);
}

}  // namespace citystream::codec::mesh
