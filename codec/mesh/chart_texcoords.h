// Texture coordinates of each chart in a tile as numbers of 16 bits: base + (q << shift).
#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "codec/mesh/mesh_tile.h"

namespace citystream::codec::mesh {

class ChartTexcoords {
  public:
    static constexpr uint32_t kBits = 16;

    /// Takes the charts' ranges. O(corners log charts).
    explicit ChartTexcoords(const MeshTile& tile);

    /// The nearest coordinate that the chart can say; {0, 0} of a colour. Never past the chart's largest one, so that
    /// it stays an int32. The coordinates of the tile that was given only.
    std::array<int32_t, 2> rounded(uint32_t chart_word, const int32_t texcoord[2]) const;

  private:
    struct Range {
        std::array<int32_t, 2> low, high;
    };
    std::map<uint32_t, Range> ranges_;
};

}  // namespace citystream::codec::mesh
