#include "codec/facade/run_grid.h"

#include <algorithm>
#include <string>

namespace citystream::codec::facade {

namespace {

/// The kept breaks of one axis: those where `differs(i)` says that run i is unlike run i - 1.
template <typename Differs>
std::vector<uint32_t> kept_runs(uint32_t count, Differs differs) {
    std::vector<uint32_t> kept = {0};
    for (uint32_t i = 1; i < count; ++i) {
        if (differs(i)) kept.push_back(i);
    }
    return kept;
}

std::vector<uint32_t> breaks_of(const std::vector<uint32_t>& runs, uint32_t end) {
    std::vector<uint32_t> breaks = runs;
    breaks.push_back(end);
    return breaks;
}

/// Columns that differ from their left neighbour, by one pass over the rows.
std::vector<uint8_t> column_cuts(const FacadeMatrices& matrices) {
    std::vector<uint8_t> cut(matrices.width, 0);
    for (size_t row = 0; row < matrices.height; ++row) {
        const int16_t* depth = &matrices.displacement_mm[row * matrices.width];
        const uint16_t* material = &matrices.material[row * matrices.width];
        for (size_t x = 1; x < matrices.width; ++x)
            cut[x] |= static_cast<uint8_t>((depth[x] != depth[x - 1]) | (material[x] != material[x - 1]));
    }
    return cut;
}

bool rows_equal(const FacadeMatrices& matrices, size_t a, size_t b) {
    const auto same = [&](const auto& matrix) {
        const auto first = matrix.begin() + static_cast<std::ptrdiff_t>(a * matrices.width);
        return std::equal(first, first + matrices.width,
                          matrix.begin() + static_cast<std::ptrdiff_t>(b * matrices.width));
    };
    return same(matrices.displacement_mm) && same(matrices.material);
}

bool rises(const std::vector<uint32_t>& breaks) {
    return breaks.size() >= 2 && breaks.front() == 0 && breaks.back() <= kMaxFacadeSide &&
           std::adjacent_find(breaks.begin(), breaks.end(), std::greater_equal<>()) == breaks.end();
}

}  // namespace

DepthRange RunGrid::depths() const {
    DepthRange range{INT32_MAX, INT32_MIN};
    for (const uint32_t label : labels) {
        const int32_t depth = displacement_of(label);
        if (depth == kOpenDisplacement) continue;
        range.min_mm = std::min(range.min_mm, depth);
        range.max_mm = std::max(range.max_mm, depth);
    }
    return range.min_mm > range.max_mm ? DepthRange{} : range;
}

bool RunGrid::has_open_cells() const {
    return std::any_of(labels.begin(), labels.end(),
                       [](uint32_t label) { return displacement_of(label) == kOpenDisplacement; });
}

Result<RunGrid> make_run_grid(const FacadeMatrices& matrices) {
    const uint32_t width = matrices.width, height = matrices.height;
    if (width == 0 || height == 0 || width > kMaxFacadeSide || height > kMaxFacadeSide) {
        return Error{"facade of " + std::to_string(width) + " x " + std::to_string(height) +
                     " texels, allowed are 1.." + std::to_string(kMaxFacadeSide)};
    }
    const size_t texels = size_t{width} * height;
    if (matrices.displacement_mm.size() != texels || matrices.material.size() != texels)
        return Error{"facade matrices do not have width x height entries"};
    const std::vector<uint8_t> cut = column_cuts(matrices);
    const auto columns = kept_runs(width, [&](uint32_t x) { return cut[x] != 0; });
    const auto rows = kept_runs(height, [&](uint32_t y) { return !rows_equal(matrices, y, y - 1); });
    RunGrid grid{breaks_of(columns, width), breaks_of(rows, height), {}};
    grid.labels.reserve(columns.size() * rows.size());
    for (const size_t y : rows) {
        for (const size_t x : columns) {
            const size_t texel = y * width + x;
            grid.labels.push_back(make_label(matrices.displacement_mm[texel], matrices.material[texel]));
        }
    }
    return grid;
}

RunGrid merge_equal_runs(const RunGrid& grid) {
    const auto columns = kept_runs(grid.columns(), [&](uint32_t c) {
        for (uint32_t r = 0; r < grid.rows(); ++r) {
            if (grid.label(c, r) != grid.label(c - 1, r)) return true;
        }
        return false;
    });
    const auto rows = kept_runs(grid.rows(), [&](uint32_t r) {
        const auto row = grid.labels.begin() + static_cast<std::ptrdiff_t>(size_t{r} * grid.columns());
        return !std::equal(row, row + grid.columns(), row - grid.columns());
    });
    RunGrid merged;
    for (const uint32_t c : columns) merged.x_breaks.push_back(grid.x_breaks[c]);
    for (const uint32_t r : rows) merged.y_breaks.push_back(grid.y_breaks[r]);
    merged.x_breaks.push_back(grid.width());
    merged.y_breaks.push_back(grid.height());
    merged.labels.reserve(columns.size() * rows.size());
    for (const uint32_t r : rows) {
        for (const uint32_t c : columns) merged.labels.push_back(grid.label(c, r));
    }
    return merged;
}

bool is_valid(const RunGrid& grid) {
    return rises(grid.x_breaks) && rises(grid.y_breaks) && grid.labels.size() == size_t{grid.columns()} * grid.rows();
}

FacadeMatrices expand(const RunGrid& grid) {
    FacadeMatrices matrices;
    matrices.width = grid.width();
    matrices.height = grid.height();
    const size_t width = grid.width();
    matrices.displacement_mm.resize(width * grid.height());
    matrices.material.resize(width * grid.height());
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        const size_t first = grid.y_breaks[row] * width;
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const uint32_t label = grid.label(column, row);
            const size_t at = first + grid.x_breaks[column];
            const size_t run = grid.x_breaks[column + 1] - grid.x_breaks[column];
            std::fill_n(&matrices.displacement_mm[at], run, static_cast<int16_t>(displacement_of(label)));
            std::fill_n(&matrices.material[at], run, static_cast<uint16_t>(material_of(label)));
        }
        for (size_t y = grid.y_breaks[row] + 1; y < grid.y_breaks[row + 1]; ++y) {
            std::copy_n(&matrices.displacement_mm[first], width, &matrices.displacement_mm[y * width]);
            std::copy_n(&matrices.material[first], width, &matrices.material[y * width]);
        }
    }
    return matrices;
}

}  // namespace citystream::codec::facade
