// Rows of a transfer matrix kept once, as they come one after the other.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>

#include "codec/radiance/transfer.h"

namespace citystream::codec::radiance {

/// Makes what distinct_rows() makes without having the whole.
class DistinctRowSet {
  public:
    /// `columns`: of the matrix.
    explicit DistinctRowSet(uint32_t columns) : distinct_{{columns, {0}, {}, {}}, {}} {}

    /// The next row of the whole: columns rising, as many quarters. O(entries).
    void add(std::span<const uint16_t> columns, std::span<const int8_t> quarters);
    /// Of the distinct rows so far.
    uint64_t nonzeros() const { return distinct_.rows.nonzeros(); }
    DistinctRows take() { return std::move(distinct_); }

  private:
    bool is_row(uint32_t row, std::span<const uint16_t> columns, std::span<const int8_t> quarters) const;

    DistinctRows distinct_;
    std::unordered_multimap<uint64_t, uint32_t> places_;  ///< of rows by their hashes
};

}  // namespace citystream::codec::radiance
