// The triangles of a mesh that are still to be coded, found by their directed edges.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace citystream::codec::mesh {

class OpenTriangles {
  public:
    /// Borrows the triangles, of three different corners each. O(n log n).
    explicit OpenTriangles(std::span<const std::array<uint32_t, 3>> triangles)
        : triangles_(triangles), open_(triangles.size(), true) {
        edges_.reserve(3 * triangles.size());
        for (uint32_t t = 0; t < triangles.size(); ++t) {
            for (size_t i = 0; i < 3; ++i) edges_.emplace_back(key(triangles[t][i], triangles[t][(i + 1) % 3]), t);
        }
        std::sort(edges_.begin(), edges_.end());
    }
    bool is_open(uint32_t triangle) const { return open_[triangle]; }
    void close(uint32_t triangle) { open_[triangle] = false; }

    /// Calls take(triangle, third corner) for each open triangle that has the edge from -> to, in order.
    template <typename Take>
    void each_with_edge(uint32_t from, uint32_t to, Take take) const {
        const uint64_t edge = key(from, to);
        auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair{edge, uint32_t{0}});
        for (; at != edges_.end() && at->first == edge; ++at) {
            if (!open_[at->second]) continue;
            const auto& t = triangles_[at->second];
            const uint32_t third = t[0] != from && t[0] != to ? t[0] : t[1] != from && t[1] != to ? t[1] : t[2];
            take(at->second, third);
        }
    }

    /// Calls take(triangle) for each open triangle that has the corner.
    template <typename Take>
    void each_with_corner(uint32_t from, Take take) const {
        auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair{key(from, 0), uint32_t{0}});
        for (; at != edges_.end() && at->first >> 32 == from; ++at) {
            if (open_[at->second]) take(at->second);
        }
    }

  private:
    static uint64_t key(uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; }

    std::span<const std::array<uint32_t, 3>> triangles_;
    std::vector<std::pair<uint64_t, uint32_t>> edges_;
    std::vector<bool> open_;
};

}  // namespace citystream::codec::mesh
