// A transfer matrix as a sum of constant-column biclusters (Sun et al. 2011, section 4.2, equations 4 to 8): sets of
// rows and of columns with one value a column, so that what the columns give is summed up once for all the rows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/transfer.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// Cluster i has rows row[row_begin[i]..row_begin[i + 1]), rising, and likewise columns, rising, with their values in
/// quarters, not 0. Neither is empty.
struct Biclusters {
    uint32_t rows = 0, columns = 0;  ///< of the matrix
    std::vector<uint32_t> row_begin{0}, column_begin{0};
    std::vector<uint32_t> row;
    std::vector<uint16_t> column;
    std::vector<int8_t> value;
    friend bool operator==(const Biclusters&, const Biclusters&) = default;

    uint32_t count() const { return static_cast<uint32_t>(row_begin.size()) - 1; }
    std::span<const uint32_t> rows_of(uint32_t cluster) const {
        return std::span(row).subspan(row_begin[cluster], row_begin[cluster + 1] - row_begin[cluster]);
    }
    std::span<const uint16_t> columns_of(uint32_t cluster) const {
        return std::span(column).subspan(column_begin[cluster], column_begin[cluster + 1] - column_begin[cluster]);
    }
    std::span<const int8_t> values_of(uint32_t cluster) const {
        return std::span(value).subspan(column_begin[cluster], column_begin[cluster + 1] - column_begin[cluster]);
    }
    /// Sum of W(B) = r + 2l - 1 (equation 7).
    uint64_t flops() const;
    void add(std::span<const uint32_t> cluster_rows, std::span<const uint16_t> cluster_columns,
             std::span<const int8_t> values);
};

/// Puts clusters in the order of their first rows (then of their first columns): rows that are near each other read
/// clusters that are near each other, and differences of numbers are small on the wire.
void sort_by_first_row(Biclusters& clusters);

/// Makes one cluster of those that have the same rows: r - 1 FLOPs less for each that goes, and fewer numbers. Columns
/// that come to 0 go, too; a cluster whose sums would leave int8 stays by itself.
void merge_equal_rows(Biclusters& clusters);

/// Each row as a cluster of its own; rows without entries are none.
Biclusters rows_as_clusters(const Transfer& rows);

/// The matrix that the clusters add up to, which must be within int8. O(entries of clusters).
Transfer sum_of(const Biclusters& clusters);

/// The same of clusters from anywhere. Error: more than `most_entries`, or one that is not of 1..`most_quarters`.
Result<Transfer> checked_sum_of(const Biclusters& clusters, uint64_t most_entries, int32_t most_quarters);

/// What a quarter of a column counts; no weights: 1.
inline uint32_t weight_of(std::span<const uint32_t> column_weights, uint32_t column) {
    return column_weights.empty() ? 1 : column_weights[column];
}

/// Of each row: sum of |T - sum of clusters| in quarters, or in weights where columns have some. A row's light differs
/// by no more than a quarter of the sum in quarters times the brightest texel's weighted light: |dL*_j| <= sum |q| / 4
/// L_max.
std::vector<uint32_t> row_errors(const Transfer& transfer, const Biclusters& clusters,
                                 std::span<const uint32_t> column_weights = {});

}  // namespace citystream::codec::radiance
