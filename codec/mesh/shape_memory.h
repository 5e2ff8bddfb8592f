// Triangles that come again: the same window, gable or step elsewhere in the mesh.
//
// Remembers for each shape of triangle beyond a gate where the apex was the last time, and tells it for the next gate
// of that shape, moved along. Shapes are the same if their sides are in multiples of 2^kFine grid units, else about the
// same in multiples of 2^kCoarse: equal things are rounded to the grid each on their own, so what is told may be a unit
// or so off. O(1) a call; about 100 bytes a point.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "codec/mesh/place_predictor.h"

namespace citystream::codec::mesh {

class ShapeMemory {
  public:
    static constexpr uint32_t kFine = 1, kCoarse = 4;

    struct Recalled {
        Vector place;
        bool same;  ///< not only about the same shape
    };
    /// Takes up a gate: where its apex would be if it were as the last time.
    std::optional<Recalled> recall(const GatePlaces& gate);
    /// The apex of that gate is here.
    void remember(const GridPoint& apex);

  private:
    using Memory = std::unordered_map<uint64_t, Vector>;  ///< apex from centre; only looked up, never walked
    std::array<Memory, 2> memories_;
    std::array<uint64_t, 2> keys_{};
    Vector centre_{};
};

}  // namespace citystream::codec::mesh
