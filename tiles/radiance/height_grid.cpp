#include "tiles/radiance/height_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tiles/radiance/clipped_polygon.h"

namespace citystream::tiles::radiance {

namespace {

int64_t floor_divide(int64_t a, int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
}

struct Extent {
    int64_t low = INT64_MAX, high = INT64_MIN;
    void add(int64_t value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

/// Highest point of a triangle within a cell; nothing where they do not meet. `low`: its least corner.
std::optional<int64_t> highest_within(const SurfaceTriangle& triangle, const GridPoint& low) {
    ClippedPolygon polygon;
    for (const GridPoint& corner : triangle.corners) {
        polygon.add({static_cast<double>(corner.x - low.x), static_cast<double>(corner.y - low.y),
                     static_cast<double>(corner.z - low.z)});
    }
    const auto side = static_cast<double>(kHeightCell);
    polygon.clip({1, 0}, 0);
    polygon.clip({-1, 0}, side);
    polygon.clip({0, 1}, 0);
    polygon.clip({0, -1}, side);
    if (polygon.points().empty()) return std::nullopt;
    double highest = polygon.points()[0][2];
    for (const auto& point : polygon.points()) highest = std::max(highest, point[2]);
    return low.z + static_cast<int64_t>(std::ceil(highest));
}

}  // namespace

HeightCell height_cell_of(int64_t grid_x, int64_t grid_y) {
    return {floor_divide(grid_x, kHeightCell), floor_divide(grid_y, kHeightCell)};
}

HeightGrid::HeightGrid(HeightCell low, HeightCell high, int64_t base)
    : low_(low),
      high_(high),
      base_(base),
      heights_(static_cast<size_t>((high.x - low.x + 1) * (high.y - low.y + 1)), kNothing) {}

void HeightGrid::add(const SurfaceTriangle& triangle) {
    Extent x, y, z;
    for (const GridPoint& corner : triangle.corners) {
        x.add(corner.x);
        y.add(corner.y);
        z.add(corner.z);
    }
    const HeightCell first = height_cell_of(x.low, y.low), last = height_cell_of(x.high, y.high);
    const bool one_cell = first == last;
    for (int64_t cell_y = std::max(first.y, low_.y); cell_y <= std::min(last.y, high_.y); ++cell_y) {
        for (int64_t cell_x = std::max(first.x, low_.x); cell_x <= std::min(last.x, high_.x); ++cell_x) {
            const auto highest = one_cell
                                     ? std::optional(z.high)
                                     : highest_within(triangle, {cell_x * kHeightCell, cell_y * kHeightCell, z.low});
            if (highest) raise({cell_x, cell_y}, *highest);
        }
    }
}

void HeightGrid::add(std::span<const SurfaceTriangle> triangles) {
    for (const SurfaceTriangle& triangle : triangles) add(triangle);
}

void HeightGrid::raise(HeightCell cell, int64_t height) {
    if (!holds(cell)) return;
    int32_t& there = heights_[place_of(cell)];
    there = std::max(there, static_cast<int32_t>(height - base_));
}

HeightGrid HeightGrid::part(HeightCell low, HeightCell high) const {
    HeightGrid result(low, high, base_);
    for (int64_t y = std::max(low.y, low_.y); y <= std::min(high.y, high_.y); ++y) {
        for (int64_t x = std::max(low.x, low_.x); x <= std::min(high.x, high_.x); ++x) {
            result.heights_[result.place_of({x, y})] = heights_[place_of({x, y})];
        }
    }
    return result;
}

std::optional<int64_t> HeightGrid::height(HeightCell cell) const {
    if (!holds(cell)) return std::nullopt;
    const int32_t height = heights_[place_of(cell)];
    return height == kNothing ? std::nullopt : std::optional(base_ + height);
}

bool HeightGrid::holds(HeightCell cell) const {
    return cell.x >= low_.x && cell.x <= high_.x && cell.y >= low_.y && cell.y <= high_.y;
}

size_t HeightGrid::place_of(HeightCell cell) const {
    return static_cast<size_t>((cell.y - low_.y) * (high_.x - low_.x + 1) + (cell.x - low_.x));
}

}  // namespace citystream::tiles::radiance
