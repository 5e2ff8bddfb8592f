// Equal positions become one vertex, numbered in order of first appearance.
#pragma once

#include <cstdint>
#include <vector>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

/// A hash table over a growing vertex list. Positions are equal when all three doubles are (-0 equals 0).
class VertexWelder {
  public:
    void clear();
    /// Index of `position` in `vertices`, appended when new. All calls between two clear() use the same list.
    uint32_t index_of(std::vector<Vec3>& vertices, const Vec3& position);

  private:
    void grow(const std::vector<Vec3>& vertices);

    std::vector<uint32_t> slots_;  ///< index + 1, 0 = free; size is a power of two
    size_t used_ = 0;
};

}  // namespace citystream::tiles::city
