// A matrix without its repetitions: distinct rows x distinct columns and how many texels each stands for. What the
// factorizations work on: equal rows get equal factors, so nothing is lost and a facade of a million texels has a few
// hundred of each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

struct DistinctMatrix {
    std::vector<uint32_t> row_weight, column_weight;  ///< texel rows and columns that each stands for, > 0
    std::vector<uint32_t> entries;                    ///< row by row
    std::vector<uint32_t> row_of, column_of;          ///< distinct row or column of each of the grid's rows and columns

    uint32_t rows() const { return static_cast<uint32_t>(row_weight.size()); }
    uint32_t columns() const { return static_cast<uint32_t>(column_weight.size()); }
    uint32_t entry(uint32_t row, uint32_t column) const { return entries[size_t{row} * columns() + column]; }
};

/// Of a matrix with one value for each cell of the grid, row by row. Rows and columns come in the order of their first
/// occurrence. O(cells).
DistinctMatrix make_distinct_matrix(const RunGrid& grid, std::span<const uint32_t> values);

/// The three matrices of a facade as values of the grid's cells: displacement + 32768, material.
std::vector<uint32_t> displacement_values(const RunGrid& grid);
std::vector<uint32_t> material_values(const RunGrid& grid);
inline constexpr int32_t kDisplacementBias = 32768;

}  // namespace citystream::codec::facade
