// Triangles that come again: the same window, gable or step elsewhere in the mesh.
//
// Remembers for each shape of triangle beyond a gate where the apex was the last time, and tells it for the next gate
// of that shape, moved along. Shapes are the same if their sides are in multiples of 2^kFine grid units, else about the
// same in multiples of 2^kCoarse: equal things are rounded to the grid each on their own, so what is told may be a unit
// or so off. O(1) a call; 64 to 256 bytes a point.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

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
    /// Places by key, in a table that is at most half full. A place that finds no slot soon takes another's.
    class Memory {
      public:
        const Vector* find(uint64_t key) const;
        void set(uint64_t key, const Vector& place);

      private:
        static constexpr uint32_t kFirstSlots = 64, kMostSteps = 16;
        struct Slot {
            uint64_t key = 0;  ///< 0: empty
            Vector place{};
        };
        /// Where the key is, else an empty slot where it may be put, else the first that it might have had.
        size_t slot_of(uint64_t key) const;
        void grow();

        std::vector<Slot> slots_ = std::vector<Slot>(kFirstSlots);
        size_t used_ = 0;
    };
    std::array<Memory, 2> memories_;  ///< apex from centre
    std::array<uint64_t, 2> keys_{};
    Vector centre_{};
};

}  // namespace citystream::codec::mesh
