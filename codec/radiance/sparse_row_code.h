// Columns and values of a sparse row, or of a bicluster, by the range coder: the part that csr_wire.h, row_wire.h and
// bicluster_wire.h share. Written once for both directions (codec/bits/range_coder.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/radiance/transfer.h"

namespace citystream::codec::radiance {

/// What a decoder may be made to hold. The directory says both of a layer.
struct RadianceLimits {
    uint32_t receivers = 1 << 20;
    uint64_t entries = 1 << 28;  ///< of a matrix, of clusters (rows and columns together)
};

struct SparseRow {
    std::vector<uint16_t> columns;  ///< rising
    std::vector<int8_t> values;     ///< not 0
};

/// Row j of a matrix.
inline SparseRow row_of(const Transfer& transfer, uint32_t j) {
    const auto begin = static_cast<std::ptrdiff_t>(transfer.row_begin[j]);
    const auto end = static_cast<std::ptrdiff_t>(transfer.row_begin[j + 1]);
    return {{transfer.column.begin() + begin, transfer.column.begin() + end},
            {transfer.quarters.begin() + begin, transfer.quarters.begin() + end}};
}

inline void append_row(Transfer& transfer, const SparseRow& row) {
    transfer.column.insert(transfer.column.end(), row.columns.begin(), row.columns.end());
    transfer.quarters.insert(transfer.quarters.end(), row.values.begin(), row.values.end());
    transfer.row_begin.push_back(static_cast<uint32_t>(transfer.column.size()));
}

class SparseRowCode {
  public:
    /// `columns`: of the matrix, 1..2^16. `local_count`: M.
    SparseRowCode(uint32_t columns, uint32_t local_count) : columns_(columns), last_first_(local_count, 0) {}

    /// Codes a row of local direction `local`; false when what is read is not a row of at most `most` entries.
    template <typename Coder>
    bool code(Coder& coder, uint32_t local, uint64_t most, SparseRow& row) {
        const uint32_t count = count_[local_class(local)].code(coder, static_cast<uint32_t>(row.columns.size()));
        if (count > most || count > columns_) return false;
        if constexpr (Coder::kDecodes) {
            row.columns.resize(count);
            row.values.resize(count);
        }
        return count == 0 || (code_columns(coder, local, row) && code_values(coder, row));
    }

  private:
    static constexpr uint32_t kSteps = 3, kLast = 9, kLocalClasses = 4;
    static uint32_t local_class(uint32_t local) { return local % kLocalClasses; }

    /// The first one by its difference to that of the last row of this direction, then steps less 1.
    template <typename Coder>
    bool code_columns(Coder& coder, uint32_t local, SparseRow& row) {
        auto& last_first = last_first_[local];
        const auto told = static_cast<int32_t>(row.columns[0]) - static_cast<int32_t>(last_first);
        const int64_t first = int64_t{last_first} + bits::unzigzag(first_.code(coder, bits::zigzag(told)));
        if (first < 0 || first >= columns_) return false;
        row.columns[0] = static_cast<uint16_t>(first);
        last_first = static_cast<uint32_t>(first);
        uint32_t last = 0, before = 0;
        for (size_t m = 1; m < row.columns.size(); ++m) {
            const uint32_t step = step_[last * kSteps + before].code(
                coder, static_cast<uint32_t>(row.columns[m]) - row.columns[m - 1] - 1u);
            const uint64_t column = uint64_t{row.columns[m - 1]} + 1 + step;
            if (column >= columns_) return false;
            row.columns[m] = static_cast<uint16_t>(column);
            before = last;
            last = std::min(step, kSteps - 1);
        }
        return true;
    }

    template <typename Coder>
    bool code_values(Coder& coder, SparseRow& row) {
        uint32_t last = 0;
        for (int8_t& value : row.values) {
            const uint32_t told = value == 0 ? 0 : bits::zigzag(value) - 1;
            const uint32_t code = value_[last].code(coder, told);
            value = static_cast<int8_t>(bits::unzigzag(code + 1));
            last = std::min(code + 1, kLast - 1);
        }
        return true;
    }

    uint32_t columns_;
    std::vector<uint32_t> last_first_;
    bits::NumberModel count_[kLocalClasses], first_, step_[kSteps * kSteps];
    std::vector<bits::BitTree> value_ = std::vector<bits::BitTree>(kLast, bits::BitTree(255));
};

/// What a message of a matrix begins with: rows are receivers times local directions.
struct MatrixShape {
    uint32_t local_count = 0, receivers = 0, columns = 0;
    uint32_t rows() const { return receivers * local_count; }
};

/// Rows and columns of a matrix; false when they cannot be.
template <typename Coder>
bool code_matrix_size(Coder& coder, const RadianceLimits& limits, uint32_t& local_count, uint32_t& receivers,
                      uint32_t& columns) {
    bits::NumberModel number;
    local_count = number.code(coder, local_count - 1);
    if (local_count >= 1024) return false;
    ++local_count;
    receivers = number.code(coder, receivers);
    columns = number.code(coder, columns - 1);
    if (columns >= 1u << 16) return false;
    ++columns;
    return receivers <= limits.receivers && uint64_t{receivers} * local_count < 1u << 24;
}

}  // namespace citystream::codec::radiance
