#include "codec/facade/free_boxes.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>
#include <utility>

namespace citystream::codec::facade {

namespace {

/// Whether anything stands above a height in a part of a line, in time of the logarithm's table: maxima of 16 values
/// and of powers of two of those.
class LineMaxima {
  public:
    LineMaxima(std::vector<int16_t> values, size_t length)
        : values_(std::move(values)), length_(length), blocks_((length + kBlock - 1) / kBlock) {
        const size_t lines = values_.size() / length_;
        std::vector<int16_t> level(lines * blocks_, INT16_MIN);
        for (size_t i = 0; i < values_.size(); ++i) {
            int16_t& maximum = level[i / length_ * blocks_ + i % length_ / kBlock];
            maximum = std::max(maximum, values_[i]);
        }
        levels_.push_back(std::move(level));
        for (size_t width = 1; 2 * width <= blocks_; width *= 2) {
            const std::vector<int16_t>& finer = levels_.back();
            std::vector<int16_t> coarser = finer;
            for (size_t line = 0; line < lines; ++line) {
                for (size_t b = 0; b + 2 * width <= blocks_; ++b) {
                    const size_t at = line * blocks_ + b;
                    coarser[at] = std::max(finer[at], finer[at + width]);
                }
            }
            levels_.push_back(std::move(coarser));
        }
    }

    bool any_above(int32_t height, size_t line, size_t from, size_t to) const {
        const size_t first = (from + kBlock - 1) / kBlock, last = to / kBlock;
        if (first >= last) return scan(height, line, from, to);
        if (scan(height, line, from, first * kBlock) || scan(height, line, last * kBlock, to)) return true;
        const size_t level = std::bit_width((last - first) / 2);
        const std::vector<int16_t>& maxima = levels_[level];
        const size_t at = line * blocks_;
        return maxima[at + first] > height || maxima[at + last - (size_t{1} << level)] > height;
    }

  private:
    static constexpr size_t kBlock = 16;

    bool scan(int32_t height, size_t line, size_t from, size_t to) const {
        for (size_t i = from; i < to; ++i) {
            if (values_[line * length_ + i] > height) return true;
        }
        return false;
    }

    std::vector<int16_t> values_;
    size_t length_, blocks_;
    std::vector<std::vector<int16_t>> levels_;  ///< [k]: maximum of 2^k blocks from each block on
};

std::vector<int16_t> heights(const RunGrid& grid) {
    std::vector<int16_t> values;
    values.reserve(grid.labels.size());
    for (const uint32_t label : grid.labels) values.push_back(static_cast<int16_t>(displacement_of(label)));
    return values;
}

std::vector<int16_t> heights_by_column(const RunGrid& grid) {
    std::vector<int16_t> values(grid.labels.size());
    for (size_t r = 0; r < grid.rows(); ++r) {
        for (size_t c = 0; c < grid.columns(); ++c)
            values[c * grid.rows() + r] = static_cast<int16_t>(displacement_of(grid.labels[r * grid.columns() + c]));
    }
    return values;
}

/// Two opposite sides of a box on one axis: in texels, and as the runs that it reaches into.
struct Extent {
    const std::vector<uint32_t>& breaks;
    uint32_t low, high;              ///< texels low <= i < high
    uint32_t first_run, behind_run;  ///< runs first <= i < behind
    bool low_grows = true, high_grows = true;

    Extent(const std::vector<uint32_t>& grid_breaks, uint32_t run)
        : breaks(grid_breaks), low(grid_breaks[run]), high(grid_breaks[run] + 1), first_run(run), behind_run(run + 1) {}

    uint32_t room_below() const { return low - breaks[first_run]; }
    uint32_t room_above() const { return breaks[behind_run] - high; }
    /// Rounds in which no growing side comes to a break.
    uint32_t quiet_rounds() const {
        return std::min(low_grows ? room_below() : UINT32_MAX, high_grows ? room_above() : UINT32_MAX);
    }
    void grow(uint32_t rounds) {
        if (low_grows) low -= rounds;
        if (high_grows) high += rounds;
    }
    /// One texel downwards or upwards; `blocked(run)` is asked when that begins a new run.
    template <typename Blocked>
    void step_low(Blocked blocked) {
        if (low_grows && room_below() == 0) {
            low_grows = first_run > 0 && !blocked(first_run - 1);
            if (low_grows) --first_run;
        }
        if (low_grows) --low;
    }
    template <typename Blocked>
    void step_high(Blocked blocked) {
        if (high_grows && room_above() == 0) {
            high_grows = behind_run + 1 < breaks.size() && !blocked(behind_run);
            if (high_grows) ++behind_run;
        }
        if (high_grows) ++high;
    }
    bool grows() const { return low_grows || high_grows; }
};

/// A box as the cells that it holds.
struct CellBox {
    uint32_t column0 = 0, column1 = 0, row0 = 0, row1 = 0;
    friend auto operator<=>(const CellBox&, const CellBox&) = default;
};

class BoxGrower {
  public:
    explicit BoxGrower(const RunGrid& grid)
        : grid_(grid), rows_(heights(grid), grid.columns()), columns_(heights_by_column(grid), grid.rows()) {}

    CellBox grow(uint32_t column, uint32_t row) const {
        const int32_t height = displacement_of(grid_.label(column, row));
        Extent x(grid_.x_breaks, column), y(grid_.y_breaks, row);
        const auto column_blocked = [&](uint32_t c) {
            return columns_.any_above(height, c, y.first_run, y.behind_run);
        };
        const auto row_blocked = [&](uint32_t r) { return rows_.any_above(height, r, x.first_run, x.behind_run); };
        while (x.grows() || y.grows()) {
            const uint32_t quiet = std::min(x.quiet_rounds(), y.quiet_rounds());
            x.grow(quiet);
            y.grow(quiet);
            x.step_low(column_blocked);
            x.step_high(column_blocked);
            y.step_low(row_blocked);
            y.step_high(row_blocked);
        }
        return {x.first_run, x.behind_run, y.first_run, y.behind_run};
    }

  private:
    const RunGrid& grid_;
    LineMaxima rows_, columns_;
};

/// The cells of one height in grid order; those with a box are jumped over.
class CellsOfHeight {
  public:
    CellsOfHeight(std::span<const uint32_t> cells, uint32_t columns) : cells_(cells), columns_(columns) {
        next_.resize(cells.size() + 1);
        std::iota(next_.begin(), next_.end(), 0U);
        for (uint32_t i = 0; i < cells.size(); ++i) {
            if (i == 0 || cells[i] / columns != cells[i - 1] / columns) row_begins_.push_back(i);
        }
        row_begins_.push_back(static_cast<uint32_t>(cells.size()));
    }

    bool has_box(uint32_t i) const { return next_[i] != i; }

    /// Calls take(cell) for each cell without box inside the box: then it has one.
    template <typename Take>
    void take_inside(const CellBox& box, Take take) {
        const auto row_of = [&](uint32_t begin) { return cells_[begin] / columns_; };
        auto row = std::partition_point(row_begins_.begin(), row_begins_.end() - 1,
                                        [&](uint32_t begin) { return row_of(begin) < box.row0; });
        for (; row != row_begins_.end() - 1 && row_of(*row) < box.row1; ++row) {
            const size_t first_cell = size_t{row_of(*row)} * columns_;
            const auto begin = std::lower_bound(cells_.begin() + *row, cells_.begin() + *(row + 1),
                                                static_cast<uint32_t>(first_cell + box.column0));
            uint32_t i = next_without_box(static_cast<uint32_t>(begin - cells_.begin()));
            for (; i < *(row + 1) && cells_[i] < first_cell + box.column1; i = next_without_box(i)) {
                take(cells_[i]);
                next_[i] = i + 1;
            }
        }
    }

  private:
    uint32_t next_without_box(uint32_t i) {
        uint32_t end = i;
        while (next_[end] != end) end = next_[end];
        while (next_[i] != i) i = std::exchange(next_[i], end);
        return end;
    }

    std::span<const uint32_t> cells_;
    uint32_t columns_;
    std::vector<uint32_t> next_;  ///< itself when without box
    std::vector<uint32_t> row_begins_;
};

/// Cells sorted by displacement, in grid order where that is equal; `begins` of each displacement.
std::vector<uint32_t> cells_by_height(const RunGrid& grid, std::vector<uint32_t>& begins) {
    begins.assign(65537, 0);
    const auto key = [](uint32_t label) { return static_cast<uint16_t>(displacement_of(label) + 32768); };
    for (const uint32_t label : grid.labels) ++begins[key(label) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<uint32_t> cells(grid.labels.size());
    std::vector<uint32_t> next = begins;
    for (uint32_t cell = 0; cell < cells.size(); ++cell) cells[next[key(grid.labels[cell])]++] = cell;
    return cells;
}

/// Puts boxes with equal sides together and numbers them in the order of the cells.
FreeBoxes index_boxes(const RunGrid& grid, const std::vector<CellBox>& grown, std::vector<uint32_t> box_of_cell) {
    std::vector<uint32_t> sorted(grown.size());
    std::iota(sorted.begin(), sorted.end(), 0U);
    std::sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) { return grown[a] < grown[b]; });
    std::vector<uint32_t> same(grown.size());
    for (size_t i = 0; i < sorted.size(); ++i) {
        const bool repeats = i > 0 && grown[sorted[i]] == grown[sorted[i - 1]];
        same[sorted[i]] = repeats ? same[sorted[i - 1]] : sorted[i];
    }
    FreeBoxes result;
    std::vector<uint32_t> number(grown.size(), UINT32_MAX);
    for (uint32_t& box : box_of_cell) {
        const CellBox& cells = grown[same[box]];
        uint32_t& index = number[same[box]];
        if (index == UINT32_MAX) {
            index = static_cast<uint32_t>(result.boxes.size());
            result.boxes.push_back({grid.x_breaks[cells.column0], grid.x_breaks[cells.column1],
                                    grid.y_breaks[cells.row0], grid.y_breaks[cells.row1]});
        }
        box = index;
    }
    result.box_index = std::move(box_of_cell);
    return result;
}

}  // namespace

FreeBoxes grow_free_boxes(const RunGrid& grid) {
    const BoxGrower grower(grid);
    std::vector<uint32_t> begins;
    const std::vector<uint32_t> cells = cells_by_height(grid, begins);
    std::vector<CellBox> grown;
    std::vector<uint32_t> box_of_cell(cells.size());
    // Boxes of different heights have nothing to do with each other.
    for (size_t height = 0; height + 1 < begins.size(); ++height) {
        if (begins[height] == begins[height + 1]) continue;
        const auto of_height = std::span(cells).subspan(begins[height], begins[height + 1] - begins[height]);
        CellsOfHeight without_box(of_height, grid.columns());
        for (uint32_t i = 0; i < of_height.size(); ++i) {
            if (without_box.has_box(i)) continue;
            const CellBox box = grower.grow(of_height[i] % grid.columns(), of_height[i] / grid.columns());
            without_box.take_inside(box,
                                    [&](uint32_t cell) { box_of_cell[cell] = static_cast<uint32_t>(grown.size()); });
            grown.push_back(box);
        }
    }
    return index_boxes(grid, grown, std::move(box_of_cell));
}

}  // namespace citystream::codec::facade
