#include "codec/radiance/bicluster.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

#include "codec/radiance/bicluster_search.h"
#include "codec/radiance/bicluster_wire.h"
#include "codec/stop.h"

namespace citystream::codec::radiance {

namespace {

/// Steele, Lea and Flood's SplitMix64: the same numbers on every machine.
class SplitMix {
  public:
    explicit SplitMix(uint64_t seed) : state_(seed) {}
    /// 0..count - 1.
    uint32_t below(uint32_t count) {
        state_ += 0x9e3779b97f4a7c15u;
        uint64_t z = state_;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return static_cast<uint32_t>(((z ^ z >> 31) >> 32) * count >> 32);
    }

  private:
    uint64_t state_;
};

struct Cluster {
    std::vector<uint32_t> rows;
    std::vector<uint16_t> columns;
    std::vector<int8_t> values;
};

Cluster sorted_cluster(const BiclusterSearch& search) {
    Cluster cluster;
    cluster.rows.assign(search.rows().begin(), search.rows().end());
    std::sort(cluster.rows.begin(), cluster.rows.end());
    for (const uint32_t k : search.columns()) cluster.columns.push_back(static_cast<uint16_t>(k));
    std::sort(cluster.columns.begin(), cluster.columns.end());
    for (const uint16_t k : cluster.columns) cluster.values.push_back(search.value(k));
    return cluster;
}

RowBudgets budgets_of(const Transfer& transfer, const BiclusterOptions& options) {
    std::vector<uint32_t> left(options.row_budgets.begin(), options.row_budgets.end());
    if (left.empty() && options.row_budget > 0) left.assign(transfer.rows(), options.row_budget);
    if (left.empty()) return {};
    return {transfer, std::move(left), options.column_weights};
}

/// Takes clusters from a matrix until nothing is left.
class Finder {
  public:
    Finder(const Transfer& transfer, const BiclusterOptions& options)
        : matrix_(transfer),
          search_(matrix_),
          options_(options),
          random_(options.random_seed),
          budgets_(budgets_of(transfer, options)) {
        found_.rows = transfer.rows();
        found_.columns = transfer.columns;
    }

    Biclusters find() {
        while (matrix_.nonzeros() > 0) {
            if (is_stopped(options_.stop)) return {};
            take_cluster();
        }
        merge_equal_rows(found_);
        sort_by_first_row(found_);
        return std::move(found_);
    }

  private:
    void take_cluster() {
        const auto filled = matrix_.filled_rows();
        const uint32_t row = filled[random_.below(static_cast<uint32_t>(filled.size()))];
        const auto entries = matrix_.row(row);
        const uint32_t seed = entries[random_.below(static_cast<uint32_t>(entries.size()))];
        if (options_.seeding == Seeding::kRow)
            search_.begin_row(row);
        else
            search_.begin(row, ShrinkingMatrix::line_of(seed));
        for (auto operation = search_.best(); operation.gain > 0; operation = search_.best()) search_.apply(operation);
        Cluster cluster = sorted_cluster(search_);
        if (is_within_budget(cluster)) {
            drop(cluster);
            return;
        }
        const size_t grown = cluster.rows.size();
        std::erase_if(cluster.rows, [&](uint32_t j) { return !matrix_.fits(j, cluster.columns, cluster.values); });
        if (cluster.rows.size() < grown)
            cluster = {
                {row}, {static_cast<uint16_t>(ShrinkingMatrix::line_of(seed))}, {ShrinkingMatrix::value_of(seed)}};
        matrix_.subtract(cluster.rows, cluster.columns, cluster.values, budgets_);
        found_.add(cluster.rows, cluster.columns, cluster.values);
    }

    /// Whether all entries of a cluster of one row may be left out.
    bool is_within_budget(const Cluster& cluster) {
        if (budgets_.empty() || cluster.rows.size() > 1) return false;
        const uint32_t row = cluster.rows[0];
        uint64_t size = 0;
        for (const uint32_t e : matrix_.row(row)) {
            const uint32_t k = ShrinkingMatrix::line_of(e);
            if (!has_column(cluster, k)) continue;
            if (!budgets_.allow(row, k, ShrinkingMatrix::value_of(e))) return false;
            size += budgets_.size_of(k, ShrinkingMatrix::value_of(e));
        }
        return size <= budgets_.left(row);
    }

    void drop(const Cluster& cluster) {
        const uint32_t row = cluster.rows[0];
        const std::vector<uint32_t> entries(matrix_.row(row).begin(), matrix_.row(row).end());
        for (const uint32_t e : entries) {
            const uint32_t k = ShrinkingMatrix::line_of(e);
            if (!has_column(cluster, k)) continue;
            if (budgets_.take(row, k, ShrinkingMatrix::value_of(e))) matrix_.drop(row, k);
        }
    }

    static bool has_column(const Cluster& cluster, uint32_t column) {
        return std::binary_search(cluster.columns.begin(), cluster.columns.end(), static_cast<uint16_t>(column));
    }

    ShrinkingMatrix matrix_;
    BiclusterSearch search_;
    BiclusterOptions options_;
    SplitMix random_;
    RowBudgets budgets_;
    Biclusters found_;
};

uint64_t cost_of(const Biclusters& clusters, BiclusterGoal goal, uint32_t local_count) {
    return goal == BiclusterGoal::kFlops ? clusters.flops() : encode_biclusters(clusters, local_count).size();
}

}  // namespace

Biclusters find_biclusters(const Transfer& transfer, const BiclusterOptions& options) {
    assert(transfer.rows() < 1u << 24);
    return Finder(transfer, options).find();
}

Biclusters best_biclusters(const Transfer& transfer, BiclusterGoal goal, uint32_t local_count, uint64_t random_seed,
                           uint32_t row_budget) {
    std::vector<uint32_t> budgets = {0};
    for (uint32_t budget = 1; budget < row_budget && budget < 1u << 31; budget *= 2) budgets.push_back(budget);
    if (row_budget > 0) budgets.push_back(row_budget);
    Biclusters best;
    uint64_t least = ~uint64_t{0};
    for (const uint32_t budget : budgets) {
        for (const Seeding seeding : {Seeding::kEntry, Seeding::kRow}) {
            Biclusters found = find_biclusters(transfer, {seeding, random_seed, budget});
            const uint64_t cost = cost_of(found, goal, local_count);
            if (cost >= least) continue;
            least = cost;
            best = std::move(found);
        }
    }
    return best;
}

}  // namespace citystream::codec::radiance
