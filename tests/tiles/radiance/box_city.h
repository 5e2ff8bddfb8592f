// Made-up surfaces for tests and benches of the radiance layer: flat ground and towers, tile by tile.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance::test {

using Surface = std::vector<SurfaceTriangle>;

inline GridPoint at(double x, double y, double z) {
    return {to_grid(x), to_grid(y), to_grid(z)};
}

inline void add(Surface& surface, const Surface& more) {
    surface.insert(surface.end(), more.begin(), more.end());
}

using Vector = std::array<double, 3>;

inline Vector vector_between(const GridPoint& from, const GridPoint& to) {
    return {static_cast<double>(to.x - from.x), static_cast<double>(to.y - from.y), static_cast<double>(to.z - from.z)};
}
inline double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vector& vector) {
    return std::sqrt(dot(vector, vector));
}
inline Vector unit_normal(const SurfaceTriangle& triangle) {
    const auto exact = exact_normal(triangle);
    const Vector normal = {static_cast<double>(exact[0]), static_cast<double>(exact[1]), static_cast<double>(exact[2])};
    const double size = length(normal);
    return {normal[0] / size, normal[1] / size, normal[2] / size};
}

/// Corners counter-clockwise seen from outside.
inline void add_quad(Surface& surface, const std::array<GridPoint, 4>& corners) {
    surface.push_back({{corners[0], corners[1], corners[2]}});
    surface.push_back({{corners[0], corners[2], corners[3]}});
}

/// Metres.
inline Surface ground(double x0, double y0, double x1, double y1, double z = 0) {
    Surface surface;
    add_quad(surface, {at(x0, y0, z), at(x1, y0, z), at(x1, y1, z), at(x0, y1, z)});
    return surface;
}

/// A square tower with roof and without floor, turned by `yaw` radians.
inline Surface tower(double x, double y, double side, double height, double yaw = 0, double foot = 0) {
    std::array<GridPoint, 4> low, high;
    for (uint32_t i = 0; i < 4; ++i) {
        const double angle = yaw + (2 * i + 1) * std::acos(-1.0) / 4, radius = side / std::sqrt(2.0);
        low[i] = at(x + radius * std::cos(angle), y + radius * std::sin(angle), foot);
        high[i] = {low[i].x, low[i].y, to_grid(height)};
    }
    Surface surface;
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t next = (i + 1) % 4;
        add_quad(surface, {low[i], low[next], high[next], high[i]});
    }
    add_quad(surface, high);
    return surface;
}

inline constexpr double kTileMetres = 128;

/// Tile (x, y) of a city: ground and 25 towers 16 m wide, 8 to 60 m high, each on a plot of 25.6 m. The same tile
/// always, whichever others are asked for.
inline Surface city_tile(int64_t x, int64_t y, bool turned) {
    const double west = static_cast<double>(x) * kTileMetres, south = static_cast<double>(y) * kTileMetres;
    Surface surface = ground(west, south, west + kTileMetres, south + kTileMetres);
    uint64_t state = static_cast<uint64_t>(x * 7919 + y * 104729 + 1000003);
    const auto random = [&state] {  // 0..1
        state = state * 6364136223846793005U + 1442695040888963407U;
        return static_cast<double>(state >> 40) / static_cast<double>(1U << 24);
    };
    for (int64_t j = 0; j < 5; ++j) {
        for (int64_t i = 0; i < 5; ++i) {
            const double plot = kTileMetres / 5, height = 8 + 52 * random(), yaw = turned ? random() * 1.5707 : 0;
            add(surface, tower(west + (static_cast<double>(i) + 0.5) * plot,
                               south + (static_cast<double>(j) + 0.5) * plot, 16, height, yaw));
        }
    }
    return surface;
}

/// The eight tiles around one.
inline Surface tiles_around(int64_t x, int64_t y, bool turned) {
    Surface surface;
    for (int64_t j = y - 1; j <= y + 1; ++j) {
        for (int64_t i = x - 1; i <= x + 1; ++i) {
            if (i != x || j != y) add(surface, city_tile(i, j, turned));
        }
    }
    return surface;
}

}  // namespace citystream::tiles::radiance::test
