#include "codec/facade/distinct_matrix.h"

#include <algorithm>
#include <string_view>
#include <unordered_map>

namespace citystream::codec::facade {

namespace {

struct DistinctLines {
    std::vector<uint32_t> first;  ///< line of the input where each distinct one comes first
    std::vector<uint32_t> of;     ///< distinct line of each line
};

DistinctLines distinct_lines(const std::vector<uint32_t>& matrix, size_t lines, size_t length) {
    DistinctLines distinct;
    distinct.of.reserve(lines);
    std::unordered_map<std::string_view, uint32_t> known;
    const char* bytes = reinterpret_cast<const char*>(matrix.data());
    const size_t line_bytes = length * sizeof(uint32_t);
    for (size_t line = 0; line < lines; ++line) {
        const std::string_view key(bytes + line * line_bytes, line_bytes);
        const auto [place, added] = known.try_emplace(key, static_cast<uint32_t>(distinct.first.size()));
        if (added) distinct.first.push_back(static_cast<uint32_t>(line));
        distinct.of.push_back(place->second);
    }
    return distinct;
}

std::vector<uint32_t> weights(const DistinctLines& lines, const std::vector<uint32_t>& breaks) {
    std::vector<uint32_t> weight(lines.first.size(), 0);
    for (size_t line = 0; line < lines.of.size(); ++line) weight[lines.of[line]] += breaks[line + 1] - breaks[line];
    return weight;
}

/// Column by column of the distinct rows.
std::vector<uint32_t> transposed_rows(std::span<const uint32_t> values, const std::vector<uint32_t>& rows,
                                      size_t columns) {
    constexpr size_t kBlock = 16;  // columns at a time, so that both sides stay in cache lines
    std::vector<uint32_t> transposed(rows.size() * columns);
    for (size_t begin = 0; begin < columns; begin += kBlock) {
        const size_t end = std::min(begin + kBlock, columns);
        for (size_t r = 0; r < rows.size(); ++r) {
            for (size_t c = begin; c < end; ++c) transposed[c * rows.size() + r] = values[rows[r] * columns + c];
        }
    }
    return transposed;
}

}  // namespace

DistinctMatrix make_distinct_matrix(const RunGrid& grid, std::span<const uint32_t> values) {
    DistinctMatrix matrix;
    const std::vector<uint32_t> all(values.begin(), values.end());
    DistinctLines rows = distinct_lines(all, grid.rows(), grid.columns());
    const std::vector<uint32_t> turned = transposed_rows(all, rows.first, grid.columns());
    DistinctLines columns = distinct_lines(turned, grid.columns(), rows.first.size());
    matrix.row_weight = weights(rows, grid.y_breaks);
    matrix.column_weight = weights(columns, grid.x_breaks);
    matrix.entries.reserve(rows.first.size() * columns.first.size());
    for (const size_t row : rows.first) {
        for (const uint32_t column : columns.first) matrix.entries.push_back(all[row * grid.columns() + column]);
    }
    matrix.row_of = std::move(rows.of);
    matrix.column_of = std::move(columns.of);
    return matrix;
}

std::vector<uint32_t> displacement_values(const RunGrid& grid) {
    std::vector<uint32_t> values;
    values.reserve(grid.labels.size());
    for (const uint32_t label : grid.labels)
        values.push_back(static_cast<uint32_t>(displacement_of(label) + kDisplacementBias));
    return values;
}

std::vector<uint32_t> material_values(const RunGrid& grid) {
    std::vector<uint32_t> values;
    values.reserve(grid.labels.size());
    for (const uint32_t label : grid.labels) values.push_back(material_of(label));
    return values;
}

}  // namespace citystream::codec::facade
