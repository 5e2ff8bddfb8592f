// The search for the bands, stripes and patches that a patch map is made of: dynamic programming over bands with
// estimated bytes, then over the stripes of each band with nearly exact ones; and again, knowing what the pools hold.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// One orientation: bands along u, or along v (transposed).
class PatchSearch {
  public:
    /// Fails on more than 65,535 different labels.
    static Result<PatchSearch> create(const RunGrid& grid, bool transposed);
    PatchSearch(PatchSearch&&) noexcept;
    ~PatchSearch();

    /// One pass over bands and stripes, which knows what the passes before have pooled (mostly smaller, not always).
    /// Fails where write_patch_words fails. Time: at most about 64 x rows x columns steps of runs; less on large grids,
    /// whose bands then have fewer rows.
    Result<std::vector<uint32_t>> pass();

  private:
    struct State;
    PatchSearch();
    std::unique_ptr<State> state_;
};

}  // namespace citystream::codec::facade
