// Points by place: which of the points added so far is the n-th nearest to where one is expected. So a reader that
// knows the same points can be told a point by a small number.
//
// Points are kept in cubes of side 2^cell_bits. A search looks at the 27 cubes around the place, in each at the newest
// kMostInCube points; so its time is bounded whatever the points are, and it may find nothing. Order: by the greatest
// coordinate difference, then by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

class NearPoints {
  public:
    static constexpr uint32_t kNone = ~uint32_t{0};
    static constexpr uint32_t kMostInCube = 64;

    explicit NearPoints(uint32_t cell_bits);
    /// The next index. Coordinates may be any int32.
    void add(const GridPoint& point);
    /// Calls take(index, distance) for every point in reach of a search.
    template <typename Take>
    void each_near(const GridPoint& place, Take take) const;
    /// The newest point at exactly this place, kNone if there is none.
    uint32_t at(const GridPoint& place) const;

  private:
    struct Cube {
        int32_t x, y, z;
        bool operator==(const Cube&) const = default;
    };
    Cube cube_of(const GridPoint& point) const;
    size_t slot_of(const Cube& cube) const;
    void grow();

    uint32_t cell_bits_;
    std::vector<GridPoint> points_;
    std::vector<uint32_t> older_;  ///< in the same slot
    std::vector<uint32_t> newest_;
};

/// Greatest coordinate difference.
inline uint32_t distance_between(const GridPoint& a, const GridPoint& b) {
    uint32_t most = 0;
    for (size_t c = 0; c < 3; ++c) {
        const int64_t difference = int64_t{a[c]} - b[c];
        const auto size = static_cast<uint32_t>(difference < 0 ? -difference : difference);
        most = size > most ? size : most;
    }
    return most;
}

template <typename Take>
void NearPoints::each_near(const GridPoint& place, Take take) const {
    const Cube middle = cube_of(place);
    for (int32_t i = 0; i < 27; ++i) {
        const Cube cube{middle.x + i % 3 - 1, middle.y + i / 3 % 3 - 1, middle.z + i / 9 - 1};
        uint32_t index = newest_[slot_of(cube)];
        for (uint32_t seen = 0; index != kNone && seen < kMostInCube; ++seen, index = older_[index]) {
            if (cube_of(points_[index]) == cube) take(index, distance_between(points_[index], place));
        }
    }
}

}  // namespace citystream::codec::mesh
