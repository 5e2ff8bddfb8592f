#include "codec/mesh/binned_buffer.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace citystream::codec::mesh {
namespace {

/// Bins of levels that are sorted.
std::vector<PrecisionBin> bins_of(std::span<const uint32_t> sorted_levels, uint32_t level_of_none) {
    if (sorted_levels.empty()) return {{0, level_of_none}};
    std::vector<PrecisionBin> bins;
    for (size_t i = 0; i < sorted_levels.size(); ++i) {
        if (i == 0 || sorted_levels[i] != sorted_levels[i - 1])
            bins.push_back({static_cast<uint32_t>(i), sorted_levels[i]});
    }
    return bins;
}

}  // namespace

std::vector<uint32_t> order_by_level(std::span<const uint32_t> least_levels) {
    std::vector<uint32_t> order(least_levels.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return least_levels[a] < least_levels[b]; });
    return order;
}

PositionWords constrained_positions(std::span<const GridPoint> points, std::span<const uint32_t> most_dropped,
                                    uint32_t common_dropped, Reconstruction reading) {
    assert(points.size() == most_dropped.size());
    PositionWords result;
    result.grid = grid_of(points, common_dropped, reading);
    const uint32_t full = result.grid.full_bits();
    std::vector<uint32_t> levels;
    for (const uint32_t dropped : most_dropped) levels.push_back(full - std::min(dropped, common_dropped));
    result.order = order_by_level(levels);
    std::vector<uint32_t> sorted;
    for (const uint32_t v : result.order) {
        sorted.push_back(levels[v]);
        const auto words = result.grid.words_of(points[v]);
        result.words.insert(result.words.end(), words.begin(), words.end());
    }
    result.shape.vertices = static_cast<uint32_t>(points.size());
    result.shape.full_bits = full;
    for (size_t c = 0; c < 3; ++c) result.shape.leading[c] = full - result.grid.bits[c];
    result.shape.bins = bins_of(sorted, full - common_dropped);
    return result;
}

PositionWords adaptive_positions(std::span<const GridPoint> points, uint32_t common_dropped, Reconstruction reading) {
    const std::vector<uint32_t> most(points.size(), common_dropped);
    return constrained_positions(points, most, common_dropped, reading);
}

GridPoint shown_position(const PrecisionView& buffer, const PrecisionGrid& grid, uint32_t vertex, const DropRule& rule,
                         const std::array<int32_t, 3>& from_camera) {
    const PrecisionShape& shape = buffer.shape();
    std::array<uint32_t, 3> words{};
    const uint32_t level = buffer.fetch(vertex, words);
    // The last bin that does not begin behind the vertex.
    uint32_t least = 0;
    for (const PrecisionBin& bin : shape.bins) {
        if (bin.first_vertex <= vertex) least = bin.least_level;
    }
    const uint32_t granted = std::min(dropped_in_box(rule, from_camera, words, words), shape.full_bits - least);
    return grid.point_of(words, std::max(granted, shape.full_bits - level));
}

}  // namespace citystream::codec::mesh
