#include "codec/radiance/bicluster_search.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kNone = ~0u;
/// Residuals that an entry can hold.
constexpr int kMostValue = 127;

/// Calls both(row entry, m), row_only(row entry), cluster_only(m) for the entries of a row and the columns of a
/// cluster, columns rising.
template <typename Both, typename RowOnly, typename ClusterOnly>
void merge(std::span<const uint32_t> row, std::span<const uint16_t> columns, Both both, RowOnly row_only,
           ClusterOnly cluster_only) {
    size_t at = 0;
    for (size_t m = 0; m < columns.size(); ++m) {
        for (; at < row.size() && ShrinkingMatrix::line_of(row[at]) < columns[m]; ++at) row_only(row[at]);
        if (at < row.size() && ShrinkingMatrix::line_of(row[at]) == columns[m])
            both(row[at++], m);
        else
            cluster_only(m);
    }
    for (; at < row.size(); ++at) row_only(row[at]);
}

}  // namespace

ShrinkingMatrix::ShrinkingMatrix(const Transfer& transfer)
    : rows_(transfer.rows()),
      columns_(transfer.columns),
      place_of_row_(transfer.rows(), kNone),
      in_cluster_(transfer.rows(), 0),
      nonzeros_(transfer.nonzeros()) {
    std::vector<uint32_t> column_sizes(transfer.columns, 0);
    for (const uint16_t k : transfer.column) ++column_sizes[k];
    for (uint32_t k = 0; k < transfer.columns; ++k) columns_[k].reserve(column_sizes[k]);
    for (uint32_t j = 0; j < transfer.rows(); ++j) {
        rows_[j].reserve(transfer.row_begin[j + 1] - transfer.row_begin[j]);
        for (uint32_t i = transfer.row_begin[j]; i < transfer.row_begin[j + 1]; ++i) {
            rows_[j].push_back(entry(transfer.column[i], transfer.quarters[i]));
            columns_[transfer.column[i]].push_back(entry(j, transfer.quarters[i]));
        }
        if (rows_[j].empty()) continue;
        place_of_row_[j] = static_cast<uint32_t>(filled_rows_.size());
        filled_rows_.push_back(j);
    }
}

bool ShrinkingMatrix::fits(uint32_t row, std::span<const uint16_t> columns, std::span<const int8_t> values) const {
    bool fit = true;
    merge(
        rows_[row], columns,
        [&](uint32_t e, size_t m) { fit = fit && std::abs(value_of(e) - values[m]) <= kMostValue; }, [](uint32_t) {},
        [&](size_t m) { fit = fit && std::abs(static_cast<int>(values[m])) <= kMostValue; });
    return fit;
}

void ShrinkingMatrix::replace_row(uint32_t row, std::span<const uint32_t> entries) {
    rows_[row].assign(entries.begin(), entries.end());
    if (!entries.empty()) return;
    const uint32_t place = place_of_row_[row], last = filled_rows_.back();
    filled_rows_[place] = last;
    place_of_row_[last] = place;
    filled_rows_.pop_back();
    place_of_row_[row] = kNone;
}

/// Of a texel that the row has not: the number of all entries.
size_t RowBudgets::place(uint32_t row, uint32_t column) const {
    const auto begin = transfer_->column.begin() + transfer_->row_begin[row];
    const auto end = transfer_->column.begin() + transfer_->row_begin[row + 1];
    const auto at = std::lower_bound(begin, end, column);
    return at != end && *at == column ? static_cast<size_t>(at - transfer_->column.begin()) : quarters_.size();
}

int RowBudgets::quarters_left(uint32_t row, uint32_t column) const {
    const size_t at = place(row, column);
    return at < quarters_.size() ? quarters_[at] : 0;
}

bool RowBudgets::take(uint32_t row, uint32_t column, int residual) {
    if (!allow(row, column, residual)) return false;
    left_[row] -= size_of(column, residual);
    int8_t& quarters = quarters_[place(row, column)];
    quarters = static_cast<int8_t>(quarters - residual);
    return true;
}

void ShrinkingMatrix::subtract(std::span<const uint32_t> rows, std::span<const uint16_t> columns,
                               std::span<const int8_t> values, RowBudgets& budgets) {
    if (added_.size() < columns.size()) added_.resize(columns.size());
    for (size_t m = 0; m < columns.size(); ++m) added_[m].clear();
    for (const uint32_t row : rows) {
        merged_.clear();
        const auto leave = [&](int residual, size_t m) {
            if (budgets.take(row, columns[m], residual)) return;
            merged_.push_back(entry(columns[m], residual));
            added_[m].push_back(entry(row, residual));
        };
        merge(
            rows_[row], columns,
            [&](uint32_t e, size_t m) {
                if (value_of(e) != values[m]) leave(value_of(e) - values[m], m);
            },
            [&](uint32_t e) { merged_.push_back(e); }, [&](size_t m) { leave(-values[m], m); });
        nonzeros_ = nonzeros_ + merged_.size() - rows_[row].size();
        replace_row(row, merged_);
        in_cluster_[row] = 1;
    }
    for (size_t m = 0; m < columns.size(); ++m) {
        auto& column = columns_[columns[m]];
        std::erase_if(column, [&](uint32_t e) { return in_cluster_[line_of(e)] != 0; });
        column.insert(column.end(), added_[m].begin(), added_[m].end());
    }
    for (const uint32_t row : rows) in_cluster_[row] = 0;
}

void ShrinkingMatrix::drop(uint32_t row, uint32_t column) {
    merged_.clear();
    for (const uint32_t e : rows_[row]) {
        if (line_of(e) != column) merged_.push_back(e);
    }
    nonzeros_ -= rows_[row].size() - merged_.size();
    replace_row(row, merged_);
    std::erase_if(columns_[column], [&](uint32_t e) { return line_of(e) == row; });
}

BiclusterSearch::BiclusterSearch(const ShrinkingMatrix& matrix)
    : matrix_(matrix),
      outer_rows_(matrix.rows()),
      inner_rows_(matrix.rows()),
      outer_columns_(matrix.columns()),
      inner_columns_(matrix.columns()),
      lines_of_columns_(matrix.columns()),
      counts_(size_t{matrix.columns()} * kValues, 0),
      place_of_row_(matrix.rows(), kNone),
      place_of_column_(matrix.columns(), kNone),
      row_touched_(matrix.rows(), 0),
      column_touched_(matrix.columns(), 0) {}

void BiclusterSearch::forget() {
    for (const uint32_t row : touched_rows_) {
        if (outer_rows_.has(row)) outer_rows_.remove(row);
        if (inner_rows_.has(row)) inner_rows_.remove(row);
        row_touched_[row] = 0;
    }
    for (const uint32_t column : touched_columns_) {
        if (outer_columns_.has(column)) outer_columns_.remove(column);
        if (inner_columns_.has(column)) inner_columns_.remove(column);
        const ColumnCounts& counts = lines_of_columns_[column];
        for (int v = counts.least; v <= counts.greatest; ++v) count(column, static_cast<int8_t>(v)) = 0;
        lines_of_columns_[column] = {};
        column_touched_[column] = 0;
    }
    for (const uint32_t row : member_rows_) place_of_row_[row] = kNone;
    for (const uint32_t column : member_columns_) place_of_column_[column] = kNone;
    touched_rows_.clear();
    touched_columns_.clear();
    member_rows_.clear();
    member_columns_.clear();
    saved_ = 0;
}

void BiclusterSearch::begin(uint32_t row, uint32_t column) {
    forget();
    insert_row(row);
    for (const uint32_t e : matrix_.row(row)) {
        if (ShrinkingMatrix::line_of(e) == column) insert_column(column, ShrinkingMatrix::value_of(e));
    }
    assert(member_columns_.size() == 1);
}

void BiclusterSearch::begin_row(uint32_t row) {
    forget();
    insert_row(row);
    for (const uint32_t e : matrix_.row(row)) insert_column(ShrinkingMatrix::line_of(e), ShrinkingMatrix::value_of(e));
    assert(!member_columns_.empty());
}

BiclusterSearch::Operation BiclusterSearch::best() {
    const auto r = static_cast<int64_t>(member_rows_.size()), l = static_cast<int64_t>(member_columns_.size());
    Operation best;
    const auto consider = [&](Kind kind, uint32_t line, int64_t gain) {
        if (gain > best.gain) best = {kind, line, gain};
    };
    if (!outer_rows_.empty()) {
        const uint32_t row = outer_rows_.most();
        consider(Kind::kInsertRow, row, 2 * int64_t{outer_rows_.key(row)} - 2 * l - 1);
    }
    if (!outer_columns_.empty()) {
        const uint32_t column = outer_columns_.most();
        consider(Kind::kInsertColumn, column, 2 * int64_t{outer_columns_.key(column)} - 2 * r - 2);
    }
    if (r > 1) {
        const uint32_t row = inner_rows_.least();
        consider(Kind::kDeleteRow, row, 2 * l + 1 - 2 * int64_t{inner_rows_.key(row)});
    }
    if (l > 1) {
        const uint32_t column = inner_columns_.least();
        consider(Kind::kDeleteColumn, column, 2 * r + 2 - 2 * int64_t{inner_columns_.key(column)});
    }
    return best;
}

void BiclusterSearch::apply(const Operation& operation) {
    switch (operation.kind) {
        case Kind::kInsertRow:
            insert_row(operation.line);
            break;
        case Kind::kInsertColumn:
            insert_column(operation.line, most_frequent(operation.line));
            break;
        case Kind::kDeleteRow:
            delete_row(operation.line);
            break;
        case Kind::kDeleteColumn:
            delete_column(operation.line);
            break;
    }
    saved_ += operation.gain;
}

void BiclusterSearch::insert_row(uint32_t row) {
    uint32_t key = 0;
    if (outer_rows_.has(row)) {
        key = outer_rows_.key(row);
        outer_rows_.remove(row);
    } else if (row_touched_[row] == 0) {
        row_touched_[row] = 1;
        touched_rows_.push_back(row);
    }
    inner_rows_.add(row, key);
    place_of_row_[row] = static_cast<uint32_t>(member_rows_.size());
    member_rows_.push_back(row);
    for (const uint32_t e : matrix_.row(row))
        count_entry(ShrinkingMatrix::line_of(e), ShrinkingMatrix::value_of(e), true);
}

void BiclusterSearch::delete_row(uint32_t row) {
    const uint32_t key = inner_rows_.key(row), place = place_of_row_[row], last = member_rows_.back();
    inner_rows_.remove(row);
    outer_rows_.add(row, key);
    member_rows_[place] = last;
    place_of_row_[last] = place;
    member_rows_.pop_back();
    place_of_row_[row] = kNone;
    for (const uint32_t e : matrix_.row(row))
        count_entry(ShrinkingMatrix::line_of(e), ShrinkingMatrix::value_of(e), false);
}

void BiclusterSearch::insert_column(uint32_t column, int8_t value) {
    outer_columns_.remove(column);
    place_of_column_[column] = static_cast<uint32_t>(member_columns_.size());
    member_columns_.push_back(column);
    lines_of_columns_[column].value = value;
    inner_columns_.add(column, lines_of_columns_[column].nonzeros + count(column, value));
    for (const uint32_t e : matrix_.column(column))
        add_to_row(ShrinkingMatrix::line_of(e), ShrinkingMatrix::value_of(e) == value ? 2 : 1, true);
}

void BiclusterSearch::delete_column(uint32_t column) {
    const uint32_t place = place_of_column_[column], last = member_columns_.back();
    member_columns_[place] = last;
    place_of_column_[last] = place;
    member_columns_.pop_back();
    place_of_column_[column] = kNone;
    inner_columns_.remove(column);
    outer_columns_.add(column, lines_of_columns_[column].nonzeros + lines_of_columns_[column].mode);
    const int8_t value = lines_of_columns_[column].value;
    for (const uint32_t e : matrix_.column(column))
        add_to_row(ShrinkingMatrix::line_of(e), ShrinkingMatrix::value_of(e) == value ? 2 : 1, false);
}

void BiclusterSearch::count_entry(uint32_t column, int8_t value, bool added) {
    ColumnCounts& counts = lines_of_columns_[column];
    if (column_touched_[column] == 0) {
        column_touched_[column] = 1;
        touched_columns_.push_back(column);
    }
    uint32_t& same = count(column, value);
    if (added) {
        counts.least = std::min<int>(counts.least, value);
        counts.greatest = std::max<int>(counts.greatest, value);
        ++counts.nonzeros;
        counts.mode = std::max(counts.mode, ++same);
    } else {
        --counts.nonzeros;
        const bool was_mode = same-- == counts.mode;
        if (was_mode) counts.mode = count(column, most_frequent(column));
    }
    queue_column(column);
}

int8_t BiclusterSearch::most_frequent(uint32_t column) const {
    const ColumnCounts& counts = lines_of_columns_[column];
    auto best = static_cast<int8_t>(counts.least);
    for (int v = counts.least; v <= counts.greatest; ++v) {
        if (count(column, static_cast<int8_t>(v)) > count(column, best)) best = static_cast<int8_t>(v);
    }
    return best;
}

void BiclusterSearch::queue_column(uint32_t column) {
    const ColumnCounts& counts = lines_of_columns_[column];
    if (place_of_column_[column] != kNone) {
        inner_columns_.change(column, counts.nonzeros + count(column, counts.value));
    } else if (outer_columns_.has(column)) {
        outer_columns_.change(column, counts.nonzeros + counts.mode);
    } else {
        outer_columns_.add(column, counts.nonzeros + counts.mode);
    }
}

void BiclusterSearch::add_to_row(uint32_t row, uint32_t amount, bool added) {
    KeyQueue& queue = place_of_row_[row] != kNone ? inner_rows_ : outer_rows_;
    if (queue.has(row)) {
        queue.change(row, added ? queue.key(row) + amount : queue.key(row) - amount);
        return;
    }
    row_touched_[row] = 1;
    touched_rows_.push_back(row);
    queue.add(row, amount);
}

uint32_t BiclusterSearch::row_key(uint32_t row) const {
    if (inner_rows_.has(row)) return inner_rows_.key(row);
    return outer_rows_.has(row) ? outer_rows_.key(row) : 0;
}

uint32_t BiclusterSearch::column_key(uint32_t column) const {
    if (inner_columns_.has(column)) return inner_columns_.key(column);
    return outer_columns_.has(column) ? outer_columns_.key(column) : 0;
}

}  // namespace citystream::codec::radiance
