// Biclusters of a transfer matrix by greedy search (Sun et al. 2011, section 4.3, algorithm 1): exactly, or within an
// error that each row may have.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "codec/radiance/biclusters.h"

namespace citystream::codec::radiance {

/// What a cluster grows from.
enum class Seeding : uint8_t {
    kEntry,  ///< one entry of the remaining matrix, as in the paper
    kRow     ///< all that is left of a row: fewer and longer clusters
};

struct BiclusterOptions {
    Seeding seeding = Seeding::kEntry;
    uint64_t random_seed = 1;
    /// Quarters by which the clusters' sum may miss a row, added up over its texels; 0: exact. The light of a row is
    /// then too low by at most row_budget / 4 times the brightest texel's weighted light, and never too high: quarters
    /// are left out and none added.
    uint32_t row_budget = 0;
    /// Of each column, what a quarter of it takes from a budget; none: 1.
    std::span<const uint32_t> column_weights = {};
    /// Of each row, in place of row_budget; none: row_budget.
    std::span<const uint32_t> row_budgets = {};
    /// Once it is set (codec/stop.h) the search ends after the cluster it is at, and there are none.
    const std::atomic<bool>* stop = nullptr;
};

/// Clusters in the order of their first rows; the same for the same options. Sum of W <= 2 nnz(T); row_errors() within
/// the budgets. Values that residuals reach stay within int8: a row whose residual would not is left out of a cluster.
///
/// Rows below 2^24. Time: nonzeros of the lines of all operations: 0.5 s for the 1.9 million entries of a city
/// tile of 1,900 receivers, 0.3 s for its distinct rows.
/// Memory: about 8 bytes a nonzero and 80 a row.
Biclusters find_biclusters(const Transfer& transfer, const BiclusterOptions& options);

enum class BiclusterGoal : uint8_t {
    kFlops,  ///< least work at run time
    kBytes   ///< fewest bytes on the wire (bicluster_wire.h)
};

/// The best of both seedings, for a goal. Of a bound above 0 also the best of every smaller bound that is a power of
/// two, so that what is gained never falls as the bound grows from one power to the next. `local_count`: M.
Biclusters best_biclusters(const Transfer& transfer, BiclusterGoal goal, uint32_t local_count, uint64_t random_seed = 1,
                           uint32_t row_budget = 0);

}  // namespace citystream::codec::radiance
