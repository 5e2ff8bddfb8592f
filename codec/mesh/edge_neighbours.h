// Which earlier triangle of a list is beyond each edge of the next one, and which corners were met at its points: what
// attributes of triangles and corners are expected from.
//
// Nothing is assumed of the mesh. Of several triangles beyond an edge the newest counts. A search looks at no more than
// the newest kMostCorners corners of a point, so each triangle takes time O(1).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace citystream::codec::mesh {

class EdgeNeighbours {
  public:
    static constexpr uint32_t kNone = ~uint32_t{0};
    static constexpr uint32_t kMostCorners = 32;

    explicit EdgeNeighbours(size_t point_count) : newest_(point_count, kNone) {}

    /// Corner (3 * triangle + 0..2) from which the edge to -> from of an earlier triangle starts, kNone: there is none.
    uint32_t beyond(uint32_t from, uint32_t to) const {
        uint32_t looked_at = 0;
        for (uint32_t corner = newest_[to]; corner != kNone && looked_at < kMostCorners; corner = older_[corner]) {
            if (next_point_[corner] == from) return corner;
            ++looked_at;
        }
        return kNone;
    }
    /// Calls take(corner) for earlier corners at a point, newest first, until it returns true.
    template <typename Take>
    void each_corner_at(uint32_t point, uint32_t most, Take take) const {
        for (uint32_t corner = newest_[point]; corner != kNone && most > 0; corner = older_[corner], --most) {
            if (take(corner)) return;
        }
    }
    /// The next triangle.
    void add(const std::array<uint32_t, 3>& triangle) {
        for (size_t i = 0; i < 3; ++i) {
            older_.push_back(newest_[triangle[i]]);
            newest_[triangle[i]] = static_cast<uint32_t>(next_point_.size());
            next_point_.push_back(triangle[(i + 1) % 3]);
        }
    }

  private:
    std::vector<uint32_t> newest_;              ///< corner at each point
    std::vector<uint32_t> older_, next_point_;  ///< of each corner
};

}  // namespace citystream::codec::mesh
