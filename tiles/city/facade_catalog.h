// The facade maps of a city while it is read: each distinct map once, kept compressed, so that a city of unlike facades
// stays in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::city {

/// One thread adds; once all are in, any number of threads may read.
class FacadeCatalog {
  public:
    static constexpr double kTexelMetres = 0.01;  ///< of maps whose maker says nothing else

    /// Index of the equal map (equal relief, however it is cut into runs), stored when new. `texel_metres`: how long a
    /// texel is on the wall; of equal maps the least counts. Programming error: a grid that is not valid, a length that
    /// is not positive. O(cells).
    uint32_t add(const codec::facade::RunGrid& grid, double texel_metres = kTexelMetres);
    size_t size() const { return maps_.size(); }
    bool empty() const { return maps_.empty(); }
    /// The map back, on its coarsest grid. Programming error: index >= size().
    codec::facade::RunGrid map(uint32_t index) const;
    /// Length of a texel on the wall. Programming error: index >= size().
    double texel_metres(uint32_t index) const { return maps_[index].texel_metres; }
    /// About what the maps take in memory.
    uint64_t memory_bytes() const { return memory_bytes_; }

  private:
    struct Stored {
        std::vector<std::byte> frame;  ///< zstd
        uint32_t raw_bytes = 0;
        double texel_metres = kTexelMetres;
    };
    std::vector<Stored> maps_;
    std::unordered_multimap<uint64_t, uint32_t> by_hash_;
    uint64_t memory_bytes_ = 0;
};

}  // namespace citystream::tiles::city
