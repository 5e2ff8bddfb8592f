// A facade as its distinct rows x distinct columns: equal rows and equal columns of the run grid are kept once, and
// every run says which it is. The content of the quotient form, and what travels of the quotient and tiled forms.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

struct QuotientParts {
    std::vector<uint32_t> x_breaks, y_breaks;    ///< as in RunGrid
    std::vector<uint32_t> x_classes, y_classes;  ///< of the runs, numbered by first use
    uint32_t columns = 0, rows = 0;              ///< distinct ones
    std::vector<uint32_t> labels;                ///< rows x columns, row by row

    uint32_t label(uint32_t column, uint32_t row) const { return labels[size_t{row} * columns + column]; }
    friend bool operator==(const QuotientParts&, const QuotientParts&) = default;
};

/// O(cells).
QuotientParts make_quotient(const RunGrid& grid);

/// The grid back. O(cells), at most 256 MiB.
RunGrid expand_quotient(const QuotientParts& parts);

}  // namespace citystream::codec::facade
