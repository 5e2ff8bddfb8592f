// Boxes of free space over a facade: the matrix A of the paper (section 4.2) on the cells of a run grid.
//
// A box starts as one texel without box and grows in rounds. In each round it grows to the left, right, down and up, in
// this order, by one texel where nothing in the next column or row of the box as it is then stands higher than the
// texel that it started from; what is blocked once stays blocked; it ends when no side grows. Then every texel of the
// same displacement inside it that has no box yet ("touches its bottom") has this one. Texels start in order, row by
// row from the bottom, each row from the left.
//
// A box that reaches into a run of equal columns or rows takes all of it, as each next one is as free as the last: so
// boxes begin and end at breaks of the grid, A is constant on cells, and growing on runs gives the boxes of growing on
// texels: sides move by whole runs, only the round in which a side comes to a break is played texel by texel.
//
// Open cells are just very deep. Boxes with equal sides are one box even where their bottoms differ (the bottom is D).
#pragma once

#include <cstdint>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::codec::facade {

/// Texels x0 <= x < x1, y0 <= y < y1.
struct FreeBox {
    uint32_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    friend bool operator==(const FreeBox&, const FreeBox&) = default;
};

struct FreeBoxes {
    std::vector<FreeBox> boxes;       ///< distinct, in the order in which the first cell that has one comes
    std::vector<uint32_t> box_index;  ///< of each cell of the grid, row by row from the bottom
};

/// A of the grid. Each box costs its crossed breaks x log(cells of a side) plus one look at each of its rows that has
/// cells of its height: near-linear in cells for facades. 14 bytes a cell of memory.
FreeBoxes grow_free_boxes(const RunGrid& grid);

}  // namespace citystream::codec::facade
