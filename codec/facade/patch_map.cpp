#include "codec/facade/patch_map.h"

#include <algorithm>

#include "codec/facade/patch_search.h"
#include "codec/facade/patch_structure.h"

namespace citystream::codec::facade {

namespace {

/// Of the better orientation.
constexpr int kMorePasses = 2;
constexpr size_t kHopelessBits = 4, kSmallBits = 1u << 17;

/// The texels at which an axis is cut.
class Cuts {
  public:
    explicit Cuts(uint32_t end) : is_cut_(end + 1, 0) { is_cut_[0] = is_cut_[end] = 1; }
    void add(uint32_t at) { is_cut_[at] = 1; }
    std::vector<uint32_t> breaks() const {
        std::vector<uint32_t> breaks;
        for (uint32_t i = 0; i < is_cut_.size(); ++i) {
            if (is_cut_[i] != 0) breaks.push_back(i);
        }
        return breaks;
    }

  private:
    std::vector<uint8_t> is_cut_;
};

/// Number of the run that begins at each break.
std::vector<uint32_t> run_of_texel(const std::vector<uint32_t>& breaks) {
    std::vector<uint32_t> runs(breaks.back() + 1, 0);
    for (uint32_t i = 0; i < breaks.size(); ++i) runs[breaks[i]] = i;
    return runs;
}

struct Area {
    uint32_t x0, y0, x1, y1;  ///< texels along and across the bands
};

/// Visits every stripe of every band with its area.
template <typename Visit>
void for_each_stripe(const PatchStructure& map, Visit visit) {
    for (size_t b = 0; b < map.bands.size(); ++b) {
        const uint32_t y1 = b + 1 < map.bands.size() ? map.bands[b + 1].y0 : map.breadth;
        const auto& list = map.lists[map.bands[b].list];
        for (size_t s = 0; s < list.size(); ++s) {
            const uint32_t x1 = s + 1 < list.size() ? list[s + 1].x0 : map.length;
            visit(list[s], Area{list[s].x0, map.bands[b].y0, x1, y1});
        }
    }
}

/// Visits every cell of a patch.
template <typename Visit>
void for_each_cell(const PatchStructure& map, const PatchRecord& patch, const Area& area, Visit visit) {
    const PatchBreaks& rows = map.break_lists[patch.rows];
    const PatchBreaks& columns = map.break_lists[patch.columns];
    size_t cell = 0;
    for (size_t r = 0; r <= rows.size(); ++r) {
        const uint32_t y0 = area.y0 + (r == 0 ? 0u : rows[r - 1]);
        const uint32_t y1 = r < rows.size() ? area.y0 + rows[r] : area.y1;
        for (size_t c = 0; c <= columns.size(); ++c, ++cell) {
            const uint32_t x0 = area.x0 + (c == 0 ? 0u : columns[c - 1]);
            const uint32_t x1 = c < columns.size() ? area.x0 + columns[c] : area.x1;
            visit(cell, Area{x0, y0, x1, y1});
        }
    }
}

RunGrid expand_structure(const PatchStructure& map) {
    Cuts x_cuts(map.length), y_cuts(map.breadth);
    for_each_stripe(map, [&](const PatchStripe& stripe, const Area& area) {
        x_cuts.add(area.x0);
        y_cuts.add(area.y0);
        if (!stripe.is_patch) return;
        const PatchRecord& patch = map.patches[stripe.content];
        for (const uint32_t at : map.break_lists[patch.columns]) x_cuts.add(area.x0 + at);
        for (const uint32_t at : map.break_lists[patch.rows]) y_cuts.add(area.y0 + at);
    });
    RunGrid grid{x_cuts.breaks(), y_cuts.breaks(), {}};
    grid.labels.resize(size_t{grid.columns()} * grid.rows());
    const std::vector<uint32_t> column_of = run_of_texel(grid.x_breaks), row_of = run_of_texel(grid.y_breaks);
    const auto fill = [&](const Area& area, uint32_t label) {
        for (uint32_t r = row_of[area.y0]; r < row_of[area.y1]; ++r) {
            const auto row = grid.labels.begin() + static_cast<std::ptrdiff_t>(size_t{r} * grid.columns());
            std::fill(row + column_of[area.x0], row + column_of[area.x1], label);
        }
    };
    for_each_stripe(map, [&](const PatchStripe& stripe, const Area& area) {
        if (!stripe.is_patch) return fill(area, map.labels[stripe.content]);
        const PatchRecord& patch = map.patches[stripe.content];
        const PatchPalette& palette = map.palettes[patch.palette];
        const PatchGrid& cells = map.grids[patch.grid];
        for_each_cell(map, patch, area, [&](size_t cell, const Area& cell_area) {
            fill(cell_area, map.labels[palette[cells.cells[cell]]]);
        });
    });
    return grid;
}

using Words = Result<std::vector<uint32_t>>;

bool is_smaller(const Words& a, const Words& b) {
    return a.ok() && (!b.ok() || a->size() < b->size());
}

/// Not for noise: what takes kHopelessBits a cell of the run grid is smaller in every other form.
bool is_worth_more(const Words& words, const RunGrid& grid) {
    return words.ok() && words->size() * 32 < grid.labels.size() * kHopelessBits + kSmallBits;
}

RunGrid transposed(const RunGrid& grid) {
    RunGrid turned{grid.y_breaks, grid.x_breaks, {}};
    turned.labels.reserve(grid.labels.size());
    for (uint32_t c = 0; c < grid.columns(); ++c) {
        for (uint32_t r = 0; r < grid.rows(); ++r) turned.labels.push_back(grid.label(c, r));
    }
    return turned;
}

}  // namespace

Result<std::vector<uint32_t>> encode_patch_map(const RunGrid& given) {
    const RunGrid grid = merge_equal_runs(given);
    auto upright = PatchSearch::create(grid, false);
    if (!upright) return upright.error();
    auto turned = PatchSearch::create(grid, true);
    if (!turned) return turned.error();
    auto best = upright->pass();
    auto other = turned->pass();
    const bool turn = is_smaller(other, best);
    if (turn) best = std::move(other);
    for (int i = 0; i < kMorePasses && is_worth_more(best, grid); ++i) {
        auto words = (turn ? turned : upright)->pass();
        if (is_smaller(words, best)) best = std::move(words);
    }
    return best;
}

Status check_patch_map(std::span<const uint32_t> words) {
    const auto structure = read_patch_words(words);
    if (!structure) return structure.error();
    return Done{};
}

Result<RunGrid> decode_patch_map(std::span<const uint32_t> words) {
    const auto structure = read_patch_words(words);
    if (!structure) return structure.error();
    const RunGrid grid = expand_structure(*structure);
    return merge_equal_runs(structure->transposed ? transposed(grid) : grid);
}

}  // namespace citystream::codec::facade
