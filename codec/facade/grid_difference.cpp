#include "codec/facade/grid_difference.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <utility>
#include <vector>

namespace citystream::codec::facade {
namespace {

/// Runs of a and b that share texels, in order along one axis.
std::vector<std::pair<uint32_t, uint32_t>> shared_runs(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    std::vector<std::pair<uint32_t, uint32_t>> runs;
    for (uint32_t i = 0, j = 0; i + 1 < a.size() && j + 1 < b.size();) {
        runs.emplace_back(i, j);
        const uint32_t end = std::min(a[i + 1], b[j + 1]);
        i += a[i + 1] == end;
        j += b[j + 1] == end;
    }
    return runs;
}

}  // namespace

GridDifference difference(const RunGrid& a, const RunGrid& b) {
    assert(is_valid(a) && is_valid(b) && a.width() == b.width() && a.height() == b.height());
    const auto columns = shared_runs(a.x_breaks, b.x_breaks), rows = shared_runs(a.y_breaks, b.y_breaks);
    GridDifference found;
    for (const auto& [row_a, row_b] : rows) {
        for (const auto& [column_a, column_b] : columns) {
            const uint32_t of_a = a.label(column_a, row_a), of_b = b.label(column_b, row_b);
            if (of_a == of_b) continue;
            const int32_t depth_a = displacement_of(of_a), depth_b = displacement_of(of_b);
            if (depth_a == kOpenDisplacement || depth_b == kOpenDisplacement) {
                found.openings = found.openings || depth_a != depth_b;
                continue;
            }
            found.displacement_mm = std::max(found.displacement_mm, std::abs(depth_a - depth_b));
            found.materials = found.materials || material_of(of_a) != material_of(of_b);
        }
    }
    return found;
}

}  // namespace citystream::codec::facade
