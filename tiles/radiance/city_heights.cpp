#include "tiles/radiance/city_heights.h"

#include <algorithm>
#include <array>
#include <utility>

#include "tiles/radiance/clipped_polygon.h"

namespace citystream::tiles::radiance {

namespace {

constexpr int64_t kBlock = kHeightBlockCells * kHeightCell;

HeightCell first_cell(HeightCell block) {
    return {block.x * kHeightBlockCells, block.y * kHeightBlockCells};
}

HeightCell block_of(HeightCell cell) {
    return {cell.x >> 6, cell.y >> 6};
}
static_assert(kHeightBlockCells == 1 << 6);

bool touches(const SurfaceTriangle& triangle, HeightCell block) {
    ClippedPolygon polygon;
    for (const GridPoint& corner : triangle.corners) {
        polygon.add(
            {static_cast<double>(corner.x - block.x * kBlock), static_cast<double>(corner.y - block.y * kBlock), 0});
    }
    const auto side = static_cast<double>(kBlock);
    polygon.clip({1, 0}, 0);
    polygon.clip({-1, 0}, side);
    polygon.clip({0, 1}, 0);
    polygon.clip({0, -1}, side);
    return !polygon.points().empty();
}

/// Whether all four corners of a block are on the triangle, seen from above.
bool covers(const SurfaceTriangle& triangle, HeightCell block) {
    const auto& corners = triangle.corners;
    const int64_t turn = exact_normal(triangle)[2] < 0 ? -1 : 1;
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const int64_t x = (block.x + i) * kBlock, y = (block.y + j) * kBlock;
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint &p = corners[k], &q = corners[(k + 1) % 3];
            if (turn * ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) < 0) return false;
        }
    }
    return true;
}

}  // namespace

void CityHeights::add(std::span<const SurfaceTriangle> triangles) {
    const std::lock_guard lock(mutex_);
    for (const SurfaceTriangle& triangle : triangles) add(triangle);
}

void CityHeights::add(const SurfaceTriangle& triangle) {
    const auto& [p, q, r] = triangle.corners;
    const HeightCell low = block_of(height_cell_of(std::min({p.x, q.x, r.x}), std::min({p.y, q.y, r.y})));
    const HeightCell high = block_of(height_cell_of(std::max({p.x, q.x, r.x}), std::max({p.y, q.y, r.y})));
    if (low == high) {
        add_to_block(low, triangle, false);
        return;
    }
    const bool level = p.z == q.z && q.z == r.z && exact_normal(triangle)[2] != 0;
    for (int64_t y = low.y; y <= high.y; ++y) {
        for (int64_t x = low.x; x <= high.x; ++x) {
            if (touches(triangle, {x, y})) add_to_block({x, y}, triangle, level && covers(triangle, {x, y}));
        }
    }
}

void CityHeights::add_to_block(HeightCell block, const SurfaceTriangle& triangle, bool level) {
    Block& there = blocks_[{block.y, block.x}];
    if (level) {
        there.level = std::max(there.level, static_cast<int32_t>(triangle.corners[0].z - base_));
        return;
    }
    if (!there.cells) {
        const HeightCell low = first_cell(block);
        there.cells = std::make_unique<HeightGrid>(
            low, HeightCell{low.x + kHeightBlockCells - 1, low.y + kHeightBlockCells - 1}, base_);
    }
    there.cells->add(triangle);
}

/// The cells that both have; `first`: of the block.
void CityHeights::copy(const Block& block, int64_t base, HeightCell first, HeightGrid& to) {
    const HeightCell low = {std::max(first.x, to.low().x), std::max(first.y, to.low().y)};
    const HeightCell high = {std::min(first.x + kHeightBlockCells - 1, to.high().x),
                             std::min(first.y + kHeightBlockCells - 1, to.high().y)};
    for (int64_t y = low.y; y <= high.y; ++y) {
        for (int64_t x = low.x; x <= high.x; ++x) {
            if (block.level != HeightGrid::kNothing) to.raise({x, y}, base + block.level);
            const auto height = block.cells ? block.cells->height({x, y}) : std::nullopt;
            if (height) to.raise({x, y}, *height);
        }
    }
}

HeightGrid CityHeights::part(HeightCell low, HeightCell high) const {
    HeightGrid result(low, high, base_);
    const HeightCell first = block_of(low), last = block_of(high);
    for (int64_t y = first.y; y <= last.y; ++y) {
        for (int64_t x = first.x; x <= last.x; ++x) {
            if (const auto found = blocks_.find({y, x}); found != blocks_.end())
                copy(found->second, base_, first_cell({x, y}), result);
        }
    }
    return result;
}

uint64_t CityHeights::bytes() const {
    constexpr uint64_t kNodeBytes = 96;
    uint64_t bytes = 0;
    for (const auto& [place, block] : blocks_)
        bytes += kNodeBytes + (block.cells ? sizeof(HeightGrid) + 4 * kHeightBlockCells * kHeightBlockCells : 0);
    return bytes;
}

}  // namespace citystream::tiles::radiance
