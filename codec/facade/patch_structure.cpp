#include "codec/facade/patch_structure.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "codec/bits/bit_stream.h"

namespace citystream::codec::facade {

namespace {

/// Index of `item` in its pool, at the end of which it is put when it is new.
template <typename Item>
uint32_t pooled(std::map<Item, uint32_t>& index, std::vector<Item>& pool, const Item& item) {
    const auto [place, is_new] = index.try_emplace(item, static_cast<uint32_t>(pool.size()));
    if (is_new) pool.push_back(item);
    return place->second;
}

/// Bits of the index of one of `different` of `count` lines.
uint32_t index_bits(uint32_t count, uint32_t different) {
    return different == count ? 0 : std::max(1u, bits::bits_for(different - 1));
}

}  // namespace

uint32_t folded_bits(uint32_t rows, uint32_t columns, uint32_t different_rows, uint32_t different_columns,
                     uint32_t cell_bits) {
    return PATCH_FOLD_HEAD_BITS + rows * index_bits(rows, different_rows) +
           columns * index_bits(columns, different_columns) + different_rows * different_columns * cell_bits;
}

uint32_t FoldedGrid::bits(uint32_t cell_bits) const {
    return PATCH_FOLD_HEAD_BITS +
           static_cast<uint32_t>(row_bits * rows.size() + column_bits * columns.size() + cell_bits * cells.size());
}

FoldedGrid fold_grid(const PatchGrid& grid) {
    const size_t width = grid.columns, height = grid.cells.size() / width;
    std::vector<size_t> first_rows, first_columns;
    FoldedGrid folded;
    // Index of a line among the different ones, whose first lines are `firsts`.
    const auto index = [](std::vector<size_t>& firsts, size_t line, auto equal) {
        const auto place = std::find_if(firsts.begin(), firsts.end(), [&](size_t first) { return equal(first, line); });
        const auto found = static_cast<uint16_t>(place - firsts.begin());
        if (place == firsts.end()) firsts.push_back(line);
        return found;
    };
    for (size_t r = 0; r < height; ++r) {
        folded.rows.push_back(index(first_rows, r, [&](size_t a, size_t b) {
            const auto cells = grid.cells.begin();
            const auto at = [&](size_t row) { return cells + static_cast<std::ptrdiff_t>(row * width); };
            return std::equal(at(a), at(a + 1), at(b));
        }));
    }
    for (size_t c = 0; c < width; ++c) {
        folded.columns.push_back(index(first_columns, c, [&](size_t a, size_t b) {
            for (size_t r = 0; r < height; ++r) {
                if (grid.cells[r * width + a] != grid.cells[r * width + b]) return false;
            }
            return true;
        }));
    }
    for (const size_t r : first_rows) {
        for (const size_t c : first_columns) folded.cells.push_back(grid.cells[r * width + c]);
    }
    folded.different_columns = static_cast<uint32_t>(first_columns.size());
    folded.row_bits = index_bits(static_cast<uint32_t>(height), static_cast<uint32_t>(first_rows.size()));
    folded.column_bits = index_bits(grid.columns, folded.different_columns);
    return folded;
}

DepthRange depth_range(std::span<const uint32_t> labels) {
    DepthRange range{INT32_MAX, INT32_MIN};
    for (const uint32_t label : labels) {
        const int32_t depth = displacement_of(label);
        if (depth == kOpenDisplacement) continue;
        range = {std::min(range.min_mm, depth), std::max(range.max_mm, depth)};
    }
    return range.min_mm > range.max_mm ? DepthRange{} : range;
}

uint32_t break_width(uint32_t last_break) {
    return std::max<uint32_t>(PATCH_LEAST_BREAK_BITS, bits::bits_for(last_break));
}

bool fits_break_list(std::span<const uint16_t> breaks) {
    return breaks.empty() ||
           (breaks.size() <= PATCH_MOST_BREAKS && breaks.size() * break_width(breaks.back()) <= PATCH_BREAK_LIST_BITS);
}

uint32_t PatchBuilder::label(uint32_t word) {
    return pooled(labels_, structure_.labels, word);
}

uint32_t PatchBuilder::patch(const PatchBreaks& rows, const PatchBreaks& columns, std::span<const uint32_t> labels) {
    assert(fits_break_list(rows) && fits_break_list(columns));
    assert(labels.size() == (rows.size() + 1) * (columns.size() + 1));
    PatchGrid grid;
    PatchPalette palette;
    grid.columns = static_cast<uint32_t>(columns.size()) + 1;
    grid.cells.reserve(labels.size());
    for (const uint32_t word : labels) {
        const uint32_t index = label(word);
        auto place = std::find(palette.begin(), palette.end(), index);
        if (place == palette.end()) place = palette.insert(place, index);
        grid.cells.push_back(static_cast<uint16_t>(place - palette.begin()));
    }
    assert(palette.size() >= 2 && palette.size() <= size_t{1} << PATCH_MOST_CELL_BITS);
    grid.cell_bits = bits::bits_for(palette.size() - 1);
    PatchRecord record;
    record.rows = pooled(break_lists_, structure_.break_lists, rows);
    record.columns = pooled(break_lists_, structure_.break_lists, columns);
    record.grid = pooled(grids_, structure_.grids, grid);
    record.palette = pooled(palettes_, structure_.palettes, palette);
    return pooled(patches_, structure_.patches, record);
}

uint32_t PatchBuilder::list(const std::vector<PatchStripe>& stripes) {
    return pooled(lists_, structure_.lists, stripes);
}

}  // namespace citystream::codec::facade
