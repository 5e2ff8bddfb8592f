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

/// Coordinates << bits.
inline void make_room(std::span<GridPoint> points, uint32_t bits) {
    for (GridPoint& point : points) {
        for (int32_t& coordinate : point) coordinate = static_cast<int32_t>(static_cast<uint32_t>(coordinate) << bits);
    }
}

class PointRefinement {
  public:
    /// Adds `bits` (1..31) bits below what the points have.
    explicit PointRefinement(uint32_t bits);

    /// Refines points[index], where all points before it are refined and those from it on are not. Coordinates have
    /// room for the bits already, which are 0. The writer gives the whole point.
    template <typename Coder>
    void code(Coder& coder, std::span<GridPoint> points, uint32_t index, const Origin& origin,
              const GridPoint& whole = {}) {
        code_part(coder, points, index, origin, {bits_, 0}, whole);
    }
    /// Which of the bits a point gets: it lacks `from` bits, and will lack the lowest `to`.
    struct Part {
        uint32_t from, to;  ///< bits >= from >= to
    };
    template <typename Coder>
    void code_part(Coder& coder, std::span<GridPoint> points, uint32_t index, const Origin& origin, Part part,
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
void PointRefinement::code_part(Coder& coder, std::span<GridPoint> points, uint32_t index, const Origin& origin,
                                Part part, const GridPoint& whole) {
    expect(points, index, origin);
    for (uint32_t axis = 0; axis < 3; ++axis) {
        set_guesses(points, axis, index, origin.gate);
        int64_t value = points[index][axis];
        for (uint32_t bit = part.from; bit-- > part.to;) {
            set_contexts(axis, bit, value);
            const uint32_t one = next_.code(coder, 0, static_cast<uint32_t>(whole[axis]) >> bit & 1);
            value |= int64_t{one} << bit;
        }
        points[index][axis] = static_cast<int32_t>(value);
    }
    learn(points[index], origin);
}

}  // namespace citystream::codec::mesh
