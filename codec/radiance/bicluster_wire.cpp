#include "codec/radiance/bicluster_wire.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "codec/radiance/row_number_code.h"

namespace citystream::codec::radiance {

namespace {

/// The rows of a cluster as receivers and local directions: most go on with the same direction at the next receiver.
class RowListCode {
  public:
    explicit RowListCode(uint32_t local_count) : local_count_(local_count), local_(local_count) {}

    /// Codes the first row after that of the cluster before.
    template <typename Coder>
    uint64_t first(Coder& coder, uint64_t before, uint64_t row) {
        const auto told = static_cast<uint32_t>(row / local_count_ - before / local_count_);
        const uint64_t receiver = before / local_count_ + first_.code(coder, told);
        return receiver * local_count_ + local_.code(coder, static_cast<uint32_t>(row % local_count_));
    }

    /// Codes a further row.
    template <typename Coder>
    uint64_t next(Coder& coder, uint64_t before, uint64_t row) {
        const auto told = static_cast<uint32_t>(row / local_count_ - before / local_count_);
        const uint32_t step = step_[last_step_].code(coder, told);
        last_step_ = step < kSteps ? step : kSteps - 1;
        const uint64_t receiver = before / local_count_ + step;
        if (step == 0) return before + 1 + within_.code(coder, static_cast<uint32_t>(row - before - 1));
        const uint32_t last = static_cast<uint32_t>(before % local_count_),
                       local = static_cast<uint32_t>(row % local_count_);
        last_same_ = coder.bit(same_[last_same_], local == last ? 1 : 0);
        return receiver * local_count_ + (last_same_ != 0 ? last : local_.code(coder, local));
    }

  private:
    static constexpr uint32_t kSteps = 4;
    uint32_t local_count_, last_step_ = 1, last_same_ = 1;
    bits::NumberModel first_, within_, step_[kSteps];
    bits::BitModel same_[2];
    bits::BitTree local_;
};

/// What rows and columns of clusters may take together, and each of them by itself.
struct EntryBudget {
    uint64_t left = 0;
    uint32_t row = 1, column = 1;
};

EntryBudget any_budget(uint32_t /*clusters*/) {
    return {~uint64_t{0}};
}

/// Of the numbers below one, at least 1.
uint32_t bits_below(uint32_t count) {
    return count <= 2 ? 1 : static_cast<uint32_t>(std::bit_width(count - 1));
}

void code_size(bits::RangeEncoder& encoder, MatrixShape shape) {
    [[maybe_unused]] const bool can_be =
        code_matrix_size(encoder, {kMostReceivers, ~uint64_t{0}}, shape.local_count, shape.receivers, shape.columns);
    assert(can_be);
}

/// `budget_of(clusters)`: of so many. Null where all is well.
template <typename Coder, typename Budget>
const char* code_clusters(Coder& coder, uint32_t local_count, const Budget& budget_of, Biclusters& c) {
    bits::NumberModel number, row_count;
    const uint32_t count = number.code(coder, c.count());
    EntryBudget budget = budget_of(count);
    if (count > budget.left / (budget.row + budget.column)) return "more biclusters than there may be";
    RowListCode row_list(local_count);
    SparseRowCode row_code(c.columns, local_count);
    uint64_t first = 0;
    std::vector<uint32_t> rows;
    SparseRow entries;
    for (uint32_t i = 0; i < count; ++i) {
        if constexpr (!Coder::kDecodes) {
            rows.assign(c.rows_of(i).begin(), c.rows_of(i).end());
            entries.columns.assign(c.columns_of(i).begin(), c.columns_of(i).end());
            entries.values.assign(c.values_of(i).begin(), c.values_of(i).end());
        }
        const uint64_t r = uint64_t{row_count.code(coder, static_cast<uint32_t>(rows.size()) - 1)} + 1;
        if (r > budget.left / budget.row || r > c.rows) return "a bicluster with more rows than there may be";
        if constexpr (Coder::kDecodes) rows.resize(r);
        budget.left -= r * budget.row;
        for (size_t m = 0; m < r; ++m) {
            const uint64_t row =
                m == 0 ? row_list.first(coder, first, rows[0]) : row_list.next(coder, rows[m - 1], rows[m]);
            if (row >= c.rows) return "a bicluster with a row that is not there";
            rows[m] = static_cast<uint32_t>(row);
        }
        if (rows[0] < first) return "biclusters that are not in the order of their first rows";
        first = rows[0];
        if (!row_code.code(coder, rows[0] % local_count, budget.left / budget.column, entries) ||
            entries.columns.empty())
            return "a bicluster with columns that are not there";
        budget.left -= entries.columns.size() * budget.column;
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) return "range coded bytes end too early";
            c.add(rows, entries.columns, entries.values);
        }
    }
    return nullptr;
}

/// The first row of the whole that each distinct row is.
std::vector<uint32_t> first_uses(std::span<const uint32_t> row_of) {
    std::vector<uint32_t> first;
    for (uint32_t j = 0; j < row_of.size(); ++j) {
        if (row_of[j] == first.size()) first.push_back(j);
    }
    return first;
}

/// Null where all is well.
template <typename Coder>
const char* code_row_numbers(Coder& coder, const MatrixShape& shape, std::vector<uint32_t>& row_of) {
    RowNumberCode numbers(shape.local_count);
    uint32_t known = 0;
    for (uint32_t j = 0; j < shape.rows(); ++j) {
        if constexpr (Coder::kDecodes) {
            if (!coder.ok()) return "range coded bytes end too early";
            row_of.push_back(0);
        }
        row_of[j] = numbers.code(coder, j % shape.local_count, known, row_of[j]);
        if (row_of[j] > known) return "a row that is not there";
        known += row_of[j] == known ? 1 : 0;
    }
    return nullptr;
}

/// Rows of the whole in place of distinct rows; false where one is not a first use.
bool number_rows(std::span<const uint32_t> first_use, Biclusters& clusters) {
    for (uint32_t& row : clusters.row) {
        const auto at = std::lower_bound(first_use.begin(), first_use.end(), row);
        if (at == first_use.end() || *at != row) return false;
        row = static_cast<uint32_t>(at - first_use.begin());
    }
    clusters.rows = static_cast<uint32_t>(first_use.size());
    return true;
}

}  // namespace

std::vector<std::byte> encode_biclusters(const Biclusters& clusters, uint32_t local_count) {
    assert(local_count >= 1 && clusters.rows % local_count == 0 && clusters.columns >= 1);
    bits::RangeEncoder encoder;
    code_size(encoder, {local_count, clusters.rows / local_count, clusters.columns});
    Biclusters copy = clusters;
    [[maybe_unused]] const char* wrong = code_clusters(encoder, local_count, any_budget, copy);
    assert(wrong == nullptr);
    return encoder.finish();
}

Result<DecodedBiclusters> decode_biclusters(std::span<const std::byte> bytes, const RadianceLimits& limits) {
    bits::RangeDecoder decoder(bytes);
    MatrixShape shape{1, 0, 1};
    if (!code_matrix_size(decoder, limits, shape.local_count, shape.receivers, shape.columns))
        return Error{"biclusters of a matrix that cannot be", decoder.position()};
    Biclusters clusters;
    clusters.rows = shape.rows();
    clusters.columns = shape.columns;
    const auto budget = [&](uint32_t) { return EntryBudget{limits.entries}; };
    if (const char* wrong = code_clusters(decoder, shape.local_count, budget, clusters); wrong != nullptr)
        return Error{wrong, decoder.position()};
    if (const Status status = decoder.finish(); !status) return status.error();
    return DecodedBiclusters{std::move(clusters), shape.local_count};
}

std::vector<std::byte> encode_clustered_rows(const ClusteredRows& rows, uint32_t local_count) {
    assert(local_count >= 1 && rows.row_of.size() % local_count == 0 && rows.clusters.columns >= 1);
    const MatrixShape shape{local_count, static_cast<uint32_t>(rows.row_of.size()) / local_count,
                            rows.clusters.columns};
    ClusteredRows copy = rows;
    const std::vector<uint32_t> first_use = first_uses(rows.row_of);
    assert(first_use.size() == rows.clusters.rows);
    for (uint32_t& row : copy.clusters.row) row = first_use[row];
    copy.clusters.rows = shape.rows();
    bits::RangeEncoder encoder;
    code_size(encoder, shape);
    [[maybe_unused]] const char* wrong = code_row_numbers(encoder, shape, copy.row_of);
    assert(wrong == nullptr);
    wrong = code_clusters(encoder, local_count, any_budget, copy.clusters);
    assert(wrong == nullptr);
    return encoder.finish();
}

Result<ClusteredRows> decode_clustered_rows(std::span<const std::byte> bytes, uint32_t most_receivers,
                                            uint64_t most_bits) {
    bits::RangeDecoder decoder(bytes);
    MatrixShape shape{1, 0, 1};
    if (!code_matrix_size(decoder, {most_receivers, most_bits}, shape.local_count, shape.receivers, shape.columns))
        return Error{"biclusters of a matrix that cannot be", decoder.position()};
    ClusteredRows rows;
    if (const char* wrong = code_row_numbers(decoder, shape, rows.row_of); wrong != nullptr)
        return Error{wrong, decoder.position()};
    rows.clusters.rows = shape.rows();
    rows.clusters.columns = shape.columns;
    const auto budget = [&](uint32_t clusters) {
        return EntryBudget{most_bits, bits_below(clusters), bits_below(shape.columns)};
    };
    if (const char* wrong = code_clusters(decoder, shape.local_count, budget, rows.clusters); wrong != nullptr)
        return Error{wrong, decoder.position()};
    if (const Status status = decoder.finish(); !status) return status.error();
    if (!number_rows(first_uses(rows.row_of), rows.clusters))
        return Error{"a bicluster with a row that is told elsewhere", decoder.position()};
    return rows;
}

}  // namespace citystream::codec::radiance
