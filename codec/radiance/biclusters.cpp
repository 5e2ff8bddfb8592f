#include "codec/radiance/biclusters.h"

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace citystream::codec::radiance {

namespace {

/// Clusters of each row, as ranges of one list.
struct ClustersOfRows {
    std::vector<uint32_t> begin, cluster;
};

ClustersOfRows clusters_of_rows(const Biclusters& clusters) {
    ClustersOfRows of{std::vector<uint32_t>(clusters.rows + 1, 0), std::vector<uint32_t>(clusters.row.size())};
    for (const uint32_t row : clusters.row) ++of.begin[row + 1];
    std::partial_sum(of.begin.begin(), of.begin.end(), of.begin.begin());
    std::vector<uint32_t> place(of.begin.begin(), of.begin.end() - 1);
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        for (const uint32_t row : clusters.rows_of(i)) of.cluster[place[row]++] = i;
    }
    return of;
}

/// Sums of single rows, over a row of zeros that is put in order again after each.
class RowSums {
  public:
    explicit RowSums(const Biclusters& clusters)
        : clusters_(clusters), of_(clusters_of_rows(clusters)), sums_(clusters.columns, 0) {}

    /// Calls visit(column, sum) for every column with a sum other than 0, rising.
    template <typename Visit>
    void visit_row(uint32_t row, Visit visit) {
        columns_.clear();
        for (uint32_t i = of_.begin[row]; i < of_.begin[row + 1]; ++i) {
            const auto columns = clusters_.columns_of(of_.cluster[i]);
            const auto values = clusters_.values_of(of_.cluster[i]);
            for (size_t m = 0; m < columns.size(); ++m) {
                sums_[columns[m]] += values[m];
                columns_.push_back(columns[m]);
            }
        }
        std::sort(columns_.begin(), columns_.end());
        for (const uint16_t column : columns_) {
            if (sums_[column] != 0) visit(column, sums_[column]);
            sums_[column] = 0;
        }
    }

  private:
    const Biclusters& clusters_;
    ClustersOfRows of_;
    std::vector<int32_t> sums_;
    std::vector<uint16_t> columns_;
};

/// Columns and values of a cluster, columns rising.
using Terms = std::vector<std::pair<uint16_t, int>>;

Terms terms_of(const Biclusters& clusters, uint32_t cluster) {
    Terms terms;
    const auto columns = clusters.columns_of(cluster);
    for (size_t m = 0; m < columns.size(); ++m) terms.emplace_back(columns[m], clusters.values_of(cluster)[m]);
    return terms;
}

/// Sums by column, without zeros.
Terms sum_of_terms(const Terms& a, const Terms& b) {
    Terms both, sums;
    std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    for (const auto& [column, value] : both) {
        if (!sums.empty() && sums.back().first == column)
            sums.back().second += value;
        else
            sums.emplace_back(column, value);
    }
    std::erase_if(sums, [](const auto& term) { return term.second == 0; });
    return sums;
}

bool fits(const Terms& terms) {
    return std::all_of(terms.begin(), terms.end(), [](const auto& term) { return std::abs(term.second) <= 127; });
}

void add_terms(Biclusters& clusters, std::span<const uint32_t> rows, const Terms& terms) {
    std::vector<uint16_t> columns;
    std::vector<int8_t> values;
    for (const auto& [column, value] : terms) {
        columns.push_back(column);
        values.push_back(static_cast<int8_t>(value));
    }
    if (!columns.empty()) clusters.add(rows, columns, values);
}

}  // namespace

uint64_t Biclusters::flops() const {
    return row.size() + 2 * column.size() - count();
}

void Biclusters::add(std::span<const uint32_t> cluster_rows, std::span<const uint16_t> cluster_columns,
                     std::span<const int8_t> values) {
    row.insert(row.end(), cluster_rows.begin(), cluster_rows.end());
    column.insert(column.end(), cluster_columns.begin(), cluster_columns.end());
    value.insert(value.end(), values.begin(), values.end());
    row_begin.push_back(static_cast<uint32_t>(row.size()));
    column_begin.push_back(static_cast<uint32_t>(column.size()));
}

void sort_by_first_row(Biclusters& clusters) {
    std::vector<uint32_t> order(clusters.count());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t i) { return std::tuple(clusters.rows_of(i)[0], clusters.columns_of(i)[0], i); };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    Biclusters sorted;
    sorted.rows = clusters.rows;
    sorted.columns = clusters.columns;
    for (const uint32_t i : order) sorted.add(clusters.rows_of(i), clusters.columns_of(i), clusters.values_of(i));
    clusters = std::move(sorted);
}

void merge_equal_rows(Biclusters& clusters) {
    std::vector<uint32_t> order(clusters.count());
    std::iota(order.begin(), order.end(), 0u);
    const auto compare = [&](uint32_t a, uint32_t b) {
        const auto x = clusters.rows_of(a), y = clusters.rows_of(b);
        return std::lexicographical_compare_three_way(x.begin(), x.end(), y.begin(), y.end());
    };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return compare(a, b) < 0; });
    Biclusters merged;
    merged.rows = clusters.rows;
    merged.columns = clusters.columns;
    for (size_t i = 0; i < order.size();) {
        const uint32_t first = order[i];
        Terms terms = terms_of(clusters, first);
        for (++i; i < order.size() && compare(first, order[i]) == 0; ++i) {
            Terms sum = sum_of_terms(terms, terms_of(clusters, order[i]));
            if (fits(sum))
                terms = std::move(sum);
            else
                add_terms(merged, clusters.rows_of(order[i]), terms_of(clusters, order[i]));
        }
        add_terms(merged, clusters.rows_of(first), terms);
    }
    clusters = std::move(merged);
}

Biclusters rows_as_clusters(const Transfer& rows) {
    Biclusters clusters;
    clusters.rows = rows.rows();
    clusters.columns = rows.columns;
    for (uint32_t j = 0; j < rows.rows(); ++j) {
        const size_t begin = rows.row_begin[j], count = rows.row_begin[j + 1] - begin;
        if (count == 0) continue;
        clusters.add(std::span(&j, 1), std::span(rows.column).subspan(begin, count),
                     std::span(rows.quarters).subspan(begin, count));
    }
    return clusters;
}

Transfer sum_of(const Biclusters& clusters) {
    Transfer transfer{clusters.columns, {0}, {}, {}};
    RowSums sums(clusters);
    for (uint32_t row = 0; row < clusters.rows; ++row) {
        sums.visit_row(row, [&](uint16_t column, int32_t sum) {
            transfer.column.push_back(column);
            transfer.quarters.push_back(static_cast<int8_t>(sum));
        });
        transfer.row_begin.push_back(static_cast<uint32_t>(transfer.column.size()));
    }
    return transfer;
}

Result<Transfer> checked_sum_of(const Biclusters& clusters, uint64_t most_entries, int32_t most_quarters) {
    Transfer transfer{clusters.columns, {0}, {}, {}};
    RowSums sums(clusters);
    bool in_range = true;
    for (uint32_t row = 0; row < clusters.rows; ++row) {
        sums.visit_row(row, [&](uint16_t column, int32_t sum) {
            in_range = in_range && sum >= 1 && sum <= most_quarters;
            transfer.column.push_back(column);
            transfer.quarters.push_back(static_cast<int8_t>(sum));
        });
        if (!in_range) return Error{"biclusters that add up to what no matrix has, in row " + std::to_string(row)};
        if (transfer.nonzeros() > most_entries) return Error{"biclusters that add up to more than there may be"};
        transfer.row_begin.push_back(static_cast<uint32_t>(transfer.column.size()));
    }
    return transfer;
}

std::vector<uint32_t> row_errors(const Transfer& transfer, const Biclusters& clusters,
                                 std::span<const uint32_t> column_weights) {
    std::vector<uint32_t> errors(transfer.rows(), 0);
    RowSums sums(clusters);
    for (uint32_t row = 0; row < transfer.rows(); ++row) {
        uint32_t at = transfer.row_begin[row];
        const uint32_t end = transfer.row_begin[row + 1];
        const auto differ = [&](uint32_t column, int32_t by) {
            errors[row] += weight_of(column_weights, column) * static_cast<uint32_t>(std::abs(by));
        };
        sums.visit_row(row, [&](uint16_t column, int32_t sum) {
            for (; at < end && transfer.column[at] < column; ++at) differ(transfer.column[at], transfer.quarters[at]);
            const bool met = at < end && transfer.column[at] == column;
            differ(column, sum - (met ? transfer.quarters[at++] : 0));
        });
        for (; at < end; ++at) differ(transfer.column[at], transfer.quarters[at]);
    }
    return errors;
}

}  // namespace citystream::codec::radiance
