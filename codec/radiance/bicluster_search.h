// The greedy search for one bicluster at a time (Sun et al. 2011, algorithm 1 with the queue of section 6.1.2).
//
// What an operation changes in dW(S) = 2 nnz(S) - (r + 2l - 1) - 2 nnz(S_R) (equation 9) depends on counts of nonzeros
// alone: with eq the entries of a line that its cluster gives exactly, nz its nonzeros within the cluster's other
// lines,
//   insert row     2 (eq + nz) - 2l - 1        delete row     2l + 1 - 2 (eq + nz)
//   insert column  2 (eq + nz) - 2r - 2        delete column  2r + 2 - 2 (eq + nz)
// where a column outside would take its most frequent nonzero value. r and l are the same for all candidates, so keys
// eq + nz in bucket queues (key_queue.h) give the best operation at once, and lines without a nonzero in the cluster
// never enter a queue. An operation costs the nonzeros of its line.
//
// Every operation gains, so every cluster has dW >= 0: sum W <= 2 nnz(T), and nnz falls by W / 2 >= 1 with each.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

#include "codec/radiance/biclusters.h"
#include "codec/radiance/key_queue.h"

namespace citystream::codec::radiance {

/// How much of each row may be left out. Only what is left of the matrix' own entries is: so clusters never add up to
/// more than the matrix has, nor to less than 0.
class RowBudgets {
  public:
    /// Nothing.
    RowBudgets() = default;
    /// `left`: of each row, in quarters times weights. `weights`: of each column; none: 1. Both the transfer and the
    /// weights outlive it.
    RowBudgets(const Transfer& transfer, std::vector<uint32_t> left, std::span<const uint32_t> weights)
        : transfer_(&transfer), left_(std::move(left)), weights_(weights), quarters_(transfer.quarters) {}

    bool empty() const { return left_.empty(); }
    uint32_t left(uint32_t row) const { return left_[row]; }
    uint32_t size_of(uint32_t column, int residual) const {
        return weight_of(weights_, column) * static_cast<uint32_t>(std::abs(residual));
    }
    bool allow(uint32_t row, uint32_t column, int residual) const {
        return !left_.empty() && residual > 0 && size_of(column, residual) <= left_[row] &&
               residual <= quarters_left(row, column);
    }
    /// Leaves a residual out when it is allowed.
    bool take(uint32_t row, uint32_t column, int residual);

  private:
    size_t place(uint32_t row, uint32_t column) const;
    int quarters_left(uint32_t row, uint32_t column) const;

    const Transfer* transfer_ = nullptr;
    std::vector<uint32_t> left_;
    std::span<const uint32_t> weights_;
    std::vector<int8_t> quarters_;  ///< of each entry of the transfer, those not left out
};

/// The matrix while clusters are taken away from it, by rows and by columns. An entry is its other line << 8 | value.
class ShrinkingMatrix {
  public:
    explicit ShrinkingMatrix(const Transfer& transfer);

    uint32_t rows() const { return static_cast<uint32_t>(rows_.size()); }
    uint32_t columns() const { return static_cast<uint32_t>(columns_.size()); }
    uint64_t nonzeros() const { return nonzeros_; }
    std::span<const uint32_t> row(uint32_t j) const { return rows_[j]; }  ///< columns rising
    std::span<const uint32_t> column(uint32_t k) const { return columns_[k]; }
    /// Rows that are not empty, in an order of their own.
    std::span<const uint32_t> filled_rows() const { return filled_rows_; }
    static uint32_t line_of(uint32_t entry) { return entry >> 8; }
    static int8_t value_of(uint32_t entry) { return static_cast<int8_t>(entry & 0xff); }
    static uint32_t entry(uint32_t line, int value) { return line << 8 | (static_cast<uint32_t>(value) & 0xff); }

    /// Takes a cluster away. Columns rising. No row's residual may leave int8 (fits()). Residuals that `budgets` allow
    /// are dropped, in order of the columns.
    void subtract(std::span<const uint32_t> rows, std::span<const uint16_t> columns, std::span<const int8_t> values,
                  RowBudgets& budgets);
    bool fits(uint32_t row, std::span<const uint16_t> columns, std::span<const int8_t> values) const;
    /// Sets an entry to 0.
    void drop(uint32_t row, uint32_t column);

  private:
    void replace_row(uint32_t row, std::span<const uint32_t> entries);

    std::vector<std::vector<uint32_t>> rows_, columns_;
    std::vector<uint32_t> filled_rows_, place_of_row_;
    std::vector<uint32_t> merged_;
    std::vector<std::vector<uint32_t>> added_;  ///< of each column of the cluster, entries that are new or changed
    std::vector<uint8_t> in_cluster_;           ///< of each row
    uint64_t nonzeros_ = 0;
};

class BiclusterSearch {
  public:
    explicit BiclusterSearch(const ShrinkingMatrix& matrix);

    enum class Kind : uint8_t { kInsertRow, kInsertColumn, kDeleteRow, kDeleteColumn };
    struct Operation {
        Kind kind = Kind::kInsertRow;
        uint32_t line = 0;
        int64_t gain = 0;  ///< <= 0: there is none that pays
    };

    /// A cluster of one entry of the matrix.
    void begin(uint32_t row, uint32_t column);
    /// A cluster of all entries of a row that is not empty.
    void begin_row(uint32_t row);
    /// The operation that gains most; of equals the first of Kind's order. Single rows and columns are not deleted.
    Operation best();
    void apply(const Operation& operation);

    /// dW by adding up gains.
    int64_t saved() const { return saved_; }
    std::span<const uint32_t> rows() const { return member_rows_; }        ///< in no order
    std::span<const uint32_t> columns() const { return member_columns_; }  ///< in no order
    int8_t value(uint32_t column) const { return lines_of_columns_[column].value; }

    /// Keys as the queues have them; 0 of lines that are in none. For tests.
    uint32_t row_key(uint32_t row) const;
    uint32_t column_key(uint32_t column) const;

  private:
    /// Counts of one column over the cluster's rows.
    struct ColumnCounts {
        uint32_t nonzeros = 0, mode = 0;
        int least = 127, greatest = -128;  ///< of the values met
        int8_t value = 0;                  ///< of a member
    };
    static constexpr uint32_t kValues = 256;

    void forget();
    void insert_row(uint32_t row);
    void delete_row(uint32_t row);
    void insert_column(uint32_t column, int8_t value);
    void delete_column(uint32_t column);
    uint32_t& count(uint32_t column, int8_t value) {
        return counts_[size_t{column} * kValues + static_cast<uint8_t>(value)];
    }
    uint32_t count(uint32_t column, int8_t value) const {
        return counts_[size_t{column} * kValues + static_cast<uint8_t>(value)];
    }
    void count_entry(uint32_t column, int8_t value, bool added);
    int8_t most_frequent(uint32_t column) const;
    void queue_column(uint32_t column);
    void add_to_row(uint32_t row, uint32_t amount, bool added);

    const ShrinkingMatrix& matrix_;
    KeyQueue outer_rows_, inner_rows_, outer_columns_, inner_columns_;
    std::vector<ColumnCounts> lines_of_columns_;
    std::vector<uint32_t> counts_;  ///< of each column, of each value
    std::vector<uint32_t> member_rows_, member_columns_, place_of_row_, place_of_column_;
    std::vector<uint32_t> touched_rows_, touched_columns_;
    std::vector<uint8_t> row_touched_, column_touched_;
    int64_t saved_ = 0;
};

}  // namespace citystream::codec::radiance
