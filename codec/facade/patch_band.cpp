#include "codec/facade/patch_band.h"

#include <unordered_map>

#include "codec/facade/patch_structure.h"

namespace citystream::codec::facade {

namespace {

constexpr size_t kMostLabels = 65535;

/// Hash, changes and labels of a column over the rows of the band.
void describe(const NumberedCells& cells, BandRows rows, BandColumn& column) {
    uint32_t before = 0xffffffffu;
    for (uint32_t r = rows.first; r < rows.last; ++r) {
        const uint32_t id = cells.id(column.column, r);
        if (id == before) continue;
        if (r > rows.first) column.changes |= uint64_t{1} << (r - rows.first - 1);
        column.hash = mix_hash(column.hash, uint64_t{cells.ys[r] - cells.ys[rows.first]} << 16 | id);
        column.labels.add(id);
        before = id;
    }
}

}  // namespace

Result<NumberedCells> number_cells(const RunGrid& grid, bool transposed) {
    NumberedCells cells;
    cells.xs = transposed ? grid.y_breaks : grid.x_breaks;
    cells.ys = transposed ? grid.x_breaks : grid.y_breaks;
    cells.ids.reserve(grid.labels.size());
    std::unordered_map<uint32_t, uint16_t> numbers;
    uint32_t before = ~grid.labels[0];
    uint16_t id = 0;
    for (uint32_t r = 0; r < cells.rows(); ++r) {
        for (uint32_t c = 0; c < cells.columns(); ++c) {
            const uint32_t label = transposed ? grid.label(r, c) : grid.label(c, r);
            if (label != before) {
                const auto [place, is_new] = numbers.try_emplace(label, static_cast<uint16_t>(cells.words.size()));
                if (is_new) {
                    if (cells.words.size() == kMostLabels) return Error{"facade has more than 65535 different labels"};
                    cells.words.push_back(label);
                }
                before = label;
                id = place->second;
            }
            cells.ids.push_back(id);
        }
    }
    return cells;
}

std::vector<BandColumn> band_columns(const NumberedCells& cells, BandRows rows) {
    std::vector<uint8_t> is_new(cells.columns(), 0);
    is_new[0] = 1;
    for (uint32_t r = rows.first; r < rows.last; ++r) {
        const uint16_t* row = cells.row(r);
        for (uint32_t c = 1; c < cells.columns(); ++c) is_new[c] |= static_cast<uint8_t>(row[c] != row[c - 1]);
    }
    std::vector<BandColumn> columns;
    for (uint32_t c = 0; c < cells.columns(); ++c) {
        if (is_new[c] == 0) continue;
        columns.push_back({c, cells.xs[c], 0, 0, {}});
        describe(cells, rows, columns.back());
    }
    return columns;
}

bool rows_fit(const NumberedCells& cells, uint32_t first_row, uint64_t changes) {
    if (changes == 0) return true;
    const uint32_t count = static_cast<uint32_t>(std::popcount(changes));
    const uint32_t last = first_row + static_cast<uint32_t>(std::bit_width(changes));
    return columns_fit(count, cells.ys[last] - cells.ys[first_row]);
}

bool columns_fit(uint32_t count, uint32_t last) {
    return count <= PATCH_MOST_BREAKS && count * break_width(last) <= PATCH_BREAK_LIST_BITS;
}

}  // namespace citystream::codec::facade
