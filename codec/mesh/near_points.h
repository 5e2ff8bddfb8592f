// Points by place: which of the points added so far is the n-th nearest to where one is expected. So a reader that
// knows the same points can be told a point by a small number.
//
// Points are kept in cubes of side 2^cell_bits. A search looks at the 27 cubes around the place, in each at the newest
// kMostInCube points; so its time is bounded whatever the points are, and it may find nothing. Order: by the greatest
// coordinate difference, then by index.
#pragma once

#include <array>
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
    struct Entry {
        GridPoint place;
        uint32_t older;  ///< in the same slot
    };
    // Cubes have a side of at least 2, so that the neighbours of any cube can be numbered.
    Cube cube_of(const GridPoint& point) const {
        return {point[0] >> cell_bits_, point[1] >> cell_bits_, point[2] >> cell_bits_};
    }
    /// A slot in three parts, so that neighbours share the first ones.
    static uint64_t hash_x(int32_t x) { return static_cast<uint32_t>(x) * uint64_t{0x9e3779b97f4a7c15}; }
    static uint64_t hash_y(uint64_t hash, int32_t y) {
        return (hash ^ static_cast<uint32_t>(y)) * uint64_t{0xbf58476d1ce4e5b9};
    }
    size_t slot(uint64_t hash, int32_t z) const {
        return (((hash ^ static_cast<uint32_t>(z)) * uint64_t{0x94d049bb133111eb}) >> 32) & (newest_.size() - 1);
    }
    size_t slot_of(const Cube& cube) const { return slot(hash_y(hash_x(cube.x), cube.y), cube.z); }
    void grow();

    uint32_t cell_bits_;
    std::vector<Entry> points_;
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
    std::array<uint32_t, 27> newest{};  // all slots before any point: what has to come from memory comes at once
    size_t i = 0;
    for (int32_t x = middle.x - 1; x <= middle.x + 1; ++x) {
        const uint64_t of_x = hash_x(x);
        for (int32_t y = middle.y - 1; y <= middle.y + 1; ++y) {
            const uint64_t of_y = hash_y(of_x, y);
            for (int32_t z = middle.z - 1; z <= middle.z + 1; ++z) newest[i++] = newest_[slot(of_y, z)];
        }
    }
    i = 0;
    for (const uint32_t first : newest) {
        const auto n = static_cast<int32_t>(i++);
        const Cube cube{middle.x + n / 9 - 1, middle.y + n / 3 % 3 - 1, middle.z + n % 3 - 1};
        uint32_t index = first;
        for (uint32_t seen = 0; index != kNone && seen < kMostInCube; ++seen) {
            const Entry& entry = points_[index];
            if (cube_of(entry.place) == cube) take(index, distance_between(entry.place, place));
            index = entry.older;
        }
    }
}

}  // namespace citystream::codec::mesh
