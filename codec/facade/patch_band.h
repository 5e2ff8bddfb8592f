// What the search for a patch map sees of a facade: dense label numbers on runs, and the columns of one band.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// Rows of a band, so that the rows in which a column changes fit a word.
inline constexpr uint32_t kMostBandRows = 64;

constexpr uint64_t mix_hash(uint64_t hash, uint64_t value) {
    uint64_t mixed = (hash * 0x9e3779b97f4a7c15u + value + 1) * 0xd6e8feb86659fd93u;
    mixed ^= mixed >> 29;
    return mixed * 0xbf58476d1ce4e5b9u ^ mixed >> 32;
}

/// Set of label numbers: exact up to 128 labels, an underestimate beyond.
struct LabelSet {
    uint64_t low = 0, high = 0;
    void add(uint32_t id) { ((id & 64u) != 0 ? high : low) |= uint64_t{1} << (id & 63u); }
    void add(const LabelSet& other) {
        low |= other.low;
        high |= other.high;
    }
    uint32_t size() const { return static_cast<uint32_t>(std::popcount(low) + std::popcount(high)); }
};

/// A run grid (transposed or not) with labels as numbers.
struct NumberedCells {
    std::vector<uint32_t> xs, ys;  ///< breaks, with both ends
    std::vector<uint16_t> ids;     ///< row by row
    std::vector<uint32_t> words;   ///< label of each number

    uint32_t columns() const { return static_cast<uint32_t>(xs.size()) - 1; }
    uint32_t rows() const { return static_cast<uint32_t>(ys.size()) - 1; }
    const uint16_t* row(uint32_t r) const { return &ids[size_t{r} * columns()]; }
    uint16_t id(uint32_t column, uint32_t r) const { return row(r)[column]; }
};

/// Fails on more than 65,535 different labels.
Result<NumberedCells> number_cells(const RunGrid& grid, bool transposed);

/// Neighbouring columns that are equal in a band, as one.
struct BandColumn {
    uint32_t column = 0;   ///< the first
    uint32_t x = 0;        ///< texels
    uint64_t changes = 0;  ///< bit k: row first + 1 + k differs from the one below
    uint64_t hash = 0;     ///< of the labels and the places where they change, from the foot of the band
    LabelSet labels;
};

/// Rows first..last - 1, at most kMostBandRows.
struct BandRows {
    uint32_t first = 0, last = 0;
};

std::vector<BandColumn> band_columns(const NumberedCells& cells, BandRows rows);

/// Whether the row changes of a patch fit a break list.
bool rows_fit(const NumberedCells& cells, uint32_t first_row, uint64_t changes);
/// Whether `count` column breaks fit, the last `last` texels from the patch's edge.
bool columns_fit(uint32_t count, uint32_t last);

}  // namespace citystream::codec::facade
