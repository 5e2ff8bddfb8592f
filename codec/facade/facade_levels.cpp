#include "codec/facade/facade_levels.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "codec/facade/grid_difference.h"

namespace citystream::codec::facade {
namespace {

// Relief is drawn flat where twice its depth is below the tolerance, which is rarely less than half a pixel.
constexpr uint32_t kTexelsPerDepth = 4;
constexpr double kMostCellShare = 0.6;  // of the next finer level: more would not save a third of the bytes

/// Multiples of `texel` (or the end) between which the coarse axis has to be looked at: around every break.
std::vector<uint32_t> coarse_breaks(const std::vector<uint32_t>& breaks, uint32_t texel) {
    std::vector<uint32_t> coarse;
    for (const uint32_t at : breaks) {
        const uint32_t below = at / texel * texel;
        coarse.push_back(below);
        if (at != below) coarse.push_back(std::min(below + texel, breaks.back()));
    }
    std::sort(coarse.begin(), coarse.end());
    coarse.erase(std::unique(coarse.begin(), coarse.end()), coarse.end());
    return coarse;
}

/// Lengths of the labels inside one coarse texel; few.
class Votes {
  public:
    void clear() { votes_.clear(); }
    void add(uint32_t label, uint32_t length) {
        const auto same = std::find_if(votes_.begin(), votes_.end(), [&](const Vote& v) { return v.label == label; });
        if (same == votes_.end()) {
            votes_.push_back({label, length});
        } else {
            same->length += length;
        }
    }
    /// The longest, of those that are not recessed if `closed` and there are such; of equal ones the one that stands
    /// out furthest.
    uint32_t winner(bool closed) const {
        const auto key = [&](const Vote& v) {
            const int32_t depth = displacement_of(v.label);
            const bool recessed = depth < 0 && depth != kOpenDisplacement;
            return std::tuple(!(closed && recessed), v.length, depth, v.label);
        };
        return std::max_element(votes_.begin(), votes_.end(),
                                [&](const Vote& a, const Vote& b) { return key(a) < key(b); })
            ->label;
    }

  private:
    struct Vote {
        uint32_t label, length;
    };
    std::vector<Vote> votes_;
};

/// All open cells as one label, or they would vote against each other.
uint32_t voting_label(uint32_t label) {
    return displacement_of(label) == kOpenDisplacement ? make_label(kOpenDisplacement, 0) : label;
}

/// A facade that is closed at its left or right border stays closed: through a recess that reaches a building's corner
/// one looks past the wall.
bool is_closed(const RunGrid& grid, const RunGrid& coarse, uint32_t column, uint32_t row) {
    return (column == 0 && displacement_of(grid.label(0, row)) >= 0) ||
           (column + 1 == coarse.columns() && displacement_of(grid.label(grid.columns() - 1, row)) >= 0);
}

RunGrid coarsen_columns(const RunGrid& grid, uint32_t texel) {
    RunGrid coarse{coarse_breaks(grid.x_breaks, texel), grid.y_breaks, {}};
    coarse.labels.reserve(size_t{coarse.columns()} * coarse.rows());
    Votes votes;
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        uint32_t run = 0;
        for (uint32_t column = 0; column < coarse.columns(); ++column) {
            const uint32_t begin = coarse.x_breaks[column], end = coarse.x_breaks[column + 1];
            votes.clear();
            while (grid.x_breaks[run + 1] <= begin) ++run;
            for (uint32_t i = run; i < grid.columns() && grid.x_breaks[i] < end; ++i) {
                votes.add(voting_label(grid.label(i, row)),
                          std::min(end, grid.x_breaks[i + 1]) - std::max(begin, grid.x_breaks[i]));
            }
            coarse.labels.push_back(votes.winner(is_closed(grid, coarse, column, row)));
        }
    }
    return merge_equal_runs(coarse);
}

RunGrid transposed(const RunGrid& grid) {
    RunGrid turned{grid.y_breaks, grid.x_breaks, {}};
    turned.labels.reserve(grid.labels.size());
    for (uint32_t column = 0; column < grid.columns(); ++column) {
        for (uint32_t row = 0; row < grid.rows(); ++row) turned.labels.push_back(grid.label(column, row));
    }
    return turned;
}

}  // namespace

uint32_t texels_of(double metres, double texel_metres) {
    return static_cast<uint32_t>(std::max(1.0, std::round(metres / texel_metres)));
}

RunGrid coarsen(const RunGrid& grid, uint32_t texel) {
    assert(is_valid(grid) && texel >= 1);
    return transposed(coarsen_columns(transposed(coarsen_columns(grid, texel)), texel));
}

std::vector<FacadeLevel> make_levels(const RunGrid& grid, double texel_metres) {
    std::vector<FacadeLevel> levels;
    levels.push_back({merge_equal_runs(grid), 1, 0});
    const DepthRange depths = grid.depths();
    const auto depth_cm = static_cast<uint32_t>(std::max(std::abs(depths.min_mm), std::abs(depths.max_mm))) / 10;
    for (auto texel = kCoarseTexelsCm.rbegin(); texel != kCoarseTexelsCm.rend(); ++texel) {
        if (*texel > kTexelsPerDepth * depth_cm) break;
        RunGrid coarse = coarsen(levels.front().grid, texels_of(*texel * 0.01, texel_metres));
        const auto cells = static_cast<double>(coarse.labels.size());
        if (cells > kMostCellShare * static_cast<double>(levels.back().grid.labels.size())) continue;
        const auto error = static_cast<float>(difference(coarse, levels.front().grid).displacement_mm) * 0.001F;
        levels.push_back({std::move(coarse), *texel, std::max(error, levels.back().displacement_error)});
    }
    std::reverse(levels.begin(), levels.end());
    return levels;
}

}  // namespace citystream::codec::facade
