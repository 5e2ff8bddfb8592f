#include "tiles/layers/relief_extraction_map.h"

#include <algorithm>
#include <cmath>

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

/// A strip of one texel along a step, in texels of the map.
struct Rim {
    uint32_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
    int32_t least_mm = 0;  ///< of the fronts that it may paint
    uint32_t slot = 0;
};

class RimPainter {
  public:
    RimPainter(const CellGrid& cells, const Window& window, const RunGrid& grid)
        : cells_(cells), window_(window), grid_(grid) {}

    void note(const Part& side, uint32_t slot, double tolerance) {
        const bool across_u = std::abs(side.normal.u) > 0.9995, across_v = std::abs(side.normal.v) > 0.9995;
        if (!across_u && !across_v) return;
        Rim rim;
        const double outwards = across_u ? side.normal.u : side.normal.v;
        // The strip lies on the solid's side of the step, where the normal comes from.
        span(cells_.u, window_.left, across_u, outwards, side.low.u, side.high.u, grid_.width(), rim.x0, rim.x1);
        span(cells_.v, window_.bottom, across_v, outwards, side.low.v, side.high.v, grid_.height(), rim.y0, rim.y1);
        rim.least_mm = static_cast<int32_t>(std::lround((side.high.w - tolerance) * 1000));
        rim.slot = slot;
        if (rim.x0 < rim.x1 && rim.y0 < rim.y1) rims_.push_back(rim);
    }

    RunGrid paint() {
        std::vector<uint32_t> xs = grid_.x_breaks, ys = grid_.y_breaks;
        std::vector<Rim> needed;
        for (const Rim& rim : rims_) {
            if (!changes(rim)) continue;
            needed.push_back(rim);
            xs.insert(xs.end(), {rim.x0, rim.x1});
            ys.insert(ys.end(), {rim.y0, rim.y1});
        }
        if (needed.empty()) return grid_;
        RunGrid finer = cut(xs, ys);
        for (const Rim& rim : needed) paint_cells(finer, rim);
        return finer;
    }

  private:
    static void span(const Axis& axis, uint32_t first_cell, bool is_across, double outwards, double low, double high,
                     uint32_t size, uint32_t& from, uint32_t& to) {
        const long shift = axis.cut[first_cell];
        const auto texel = [&](double at) { return std::lround(at / axis.texel()) - shift; };
        long begin = texel(low), end = texel(high);
        if (is_across) {
            const long at = texel((low + high) / 2);
            begin = outwards > 0 ? at - 1 : at;
            end = begin + 1;
        }
        from = static_cast<uint32_t>(std::clamp(begin, 0L, static_cast<long>(size)));
        to = static_cast<uint32_t>(std::clamp(end, 0L, static_cast<long>(size)));
    }

    static uint32_t first_cell(const std::vector<uint32_t>& breaks, uint32_t texel) {
        return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end() - 1, texel) - breaks.begin()) - 1;
    }

    static bool is_painted(uint32_t label, const Rim& rim) {
        return codec::facade::displacement_of(label) >= rim.least_mm && codec::facade::material_of(label) != rim.slot;
    }

    bool changes(const Rim& rim) const {
        for (uint32_t row = first_cell(grid_.y_breaks, rim.y0); row < grid_.rows() && grid_.y_breaks[row] < rim.y1;
             ++row) {
            for (uint32_t column = first_cell(grid_.x_breaks, rim.x0);
                 column < grid_.columns() && grid_.x_breaks[column] < rim.x1; ++column) {
                if (is_painted(grid_.label(column, row), rim)) return true;
            }
        }
        return false;
    }

    RunGrid cut(std::vector<uint32_t>& xs, std::vector<uint32_t>& ys) const {
        for (std::vector<uint32_t>* breaks : {&xs, &ys}) {
            std::sort(breaks->begin(), breaks->end());
            breaks->erase(std::unique(breaks->begin(), breaks->end()), breaks->end());
        }
        RunGrid finer{xs, ys, {}};
        finer.labels.reserve(size_t{finer.columns()} * finer.rows());
        std::vector<uint32_t> from;
        for (size_t i = 0; i + 1 < xs.size(); ++i) from.push_back(first_cell(grid_.x_breaks, xs[i]));
        for (size_t i = 0; i + 1 < ys.size(); ++i) {
            const uint32_t row = first_cell(grid_.y_breaks, ys[i]);
            for (const uint32_t column : from) finer.labels.push_back(grid_.label(column, row));
        }
        return finer;
    }

    static void paint_cells(RunGrid& grid, const Rim& rim) {
        for (uint32_t row = first_cell(grid.y_breaks, rim.y0); grid.y_breaks[row] < rim.y1; ++row) {
            for (uint32_t column = first_cell(grid.x_breaks, rim.x0); grid.x_breaks[column] < rim.x1; ++column) {
                uint32_t& label = grid.labels[size_t{row} * grid.columns() + column];
                if (is_painted(label, rim)) label = make_label(codec::facade::displacement_of(label), rim.slot);
            }
        }
    }

    const CellGrid& cells_;
    const Window& window_;
    const RunGrid& grid_;
    std::vector<Rim> rims_;
};

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
    RimPainter painter(cells, window, grid);
    for (size_t i = 0; i < facade.parts.size(); ++i) {
        const Part& part = facade.parts[i];
        if (part.kind == PartKind::kSide && decision.shown[i] != 0)
            painter.note(part, slots.slot_of.at(part.look), tolerance);
    }
    ReliefMap map;
    map.grid = merge_equal_runs(painter.paint());
    map.left = cells.u.at[window.left];
    map.right = cells.u.at[window.right];
    map.bottom = cells.v.at[window.bottom];
    map.top = cells.v.at[window.top];
    return map;
}

}  // namespace citystream::tiles::layers::relief
