#include "tiles/layers/relief_extraction_map.h"

#include <algorithm>

#include "tiles/layers/relief_extraction_ledges.h"

namespace citystream::tiles::layers::relief {
namespace {

using codec::facade::kOpenDisplacement;
using codec::facade::make_label;
using codec::facade::RunGrid;

/// Columns and rows (as cells of a grid) that are not open all through.
struct Window {
    uint32_t left = 0, right = 0, bottom = 0, top = 0;
};

Window closed_window(const CellGrid& cells, const Decision& decision) {
    Window window{cells.u.cells(), 0, cells.v.cells(), 0};
    for (uint32_t row = 0; row < cells.v.cells(); ++row) {
        for (uint32_t column = 0; column < cells.u.cells(); ++column) {
            if (decision.top[size_t{row} * cells.u.cells() + column] == kNone) continue;
            window = {std::min(window.left, column), std::max(window.right, column + 1), std::min(window.bottom, row),
                      std::max(window.top, row + 1)};
        }
    }
    return window;
}

std::vector<uint32_t> cuts_of(const Axis& axis, uint32_t begin, uint32_t end) {
    std::vector<uint32_t> cuts;
    for (uint32_t i = begin; i <= end; ++i) cuts.push_back(axis.cut[i] - axis.cut[begin]);
    return cuts;
}

}  // namespace

ReliefMap make_relief_map(const CellGrid& cells, const FacadeParts& facade, const Decision& decision,
                          const SlotTable& slots, double tolerance) {
    const Window window = closed_window(cells, decision);
    RunGrid grid{cuts_of(cells.u, window.left, window.right), cuts_of(cells.v, window.bottom, window.top), {}};
    for (uint32_t row = window.bottom; row < window.top; ++row) {
        for (uint32_t column = window.left; column < window.right; ++column) {
            const uint32_t top = decision.top[size_t{row} * cells.u.cells() + column];
            if (top == kNone) {
                grid.labels.push_back(make_label(kOpenDisplacement, 0));
                continue;
            }
            const Part& part = facade.parts[top];
            grid.labels.push_back(make_label(facade.patches[part.patch].level_mm, slots.slot_of.at(part.look)));
        }
    }
    grid = merge_equal_runs(grid);
    ReliefMap map;
    map.left = cells.u.at[window.left];
    map.right = cells.u.at[window.right];
    map.bottom = cells.v.at[window.bottom];
    map.top = cells.v.at[window.top];
    map.grid = merge_equal_runs(add_ledges(grid, cells, map.left, map.bottom, facade, decision, slots, tolerance));
    return map;
}

}  // namespace citystream::tiles::layers::relief
