// Buildings and other meshes for the tests of the prism codecs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "codec/mesh/prisms.h"
#include "codec/mesh/sweep_triangles.h"

namespace citystream::codec::mesh {

using Corners = std::array<GridPoint, 3>;

/// What makes two meshes the same: every triangle by its points, turned to begin with the least, sorted.
inline std::vector<Corners> sorted_triangles(const GridMesh& mesh) {
    std::vector<Corners> sorted;
    for (const auto& t : mesh.triangles) {
        Corners corners = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        sorted.push_back(corners);
    }
    std::sort(sorted.begin(), sorted.end());
    return sorted;
}

/// A prism with all walls, cut as tessellators do.
inline Prism make_prism(std::vector<Ring> rings, int32_t base, int32_t top, bool floor = false) {
    Prism prism;
    prism.rings = std::move(rings);
    prism.base = base;
    prism.top = top;
    prism.has_floor = floor;
    for (const Ring& ring : prism.rings)
        prism.walls.resize(prism.walls.size() + ring.points.size(), {WallKind::kRising, base});
    prism.top_triangles = sweep_triangles(prism.rings);
    if (floor)
        for (const auto& t : prism.top_triangles) prism.floor_triangles.push_back({t[0], t[2], t[1]});
    return prism;
}

inline Ring rectangle(int32_t x, int32_t y, int32_t width, int32_t depth) {
    return {{{x, y}, {x + width, y}, {x + width, y + depth}, {x, y + depth}}};
}
/// Clockwise.
inline Ring courtyard(int32_t x, int32_t y, int32_t width, int32_t depth) {
    return {{{x, y}, {x, y + depth}, {x + width, y + depth}, {x + width, y}}};
}

/// A footprint of right angles with `notches` corners cut out, turned by an angle about (x, y).
inline Ring turned_footprint(double x, double y, double width, double depth, double angle, uint32_t notches) {
    std::vector<std::array<double, 2>> corners;
    const double w = width / 4, d = depth / 4;
    const std::array<std::array<double, 2>, 4> at = {{{0, 0}, {width, 0}, {width, depth}, {0, depth}}};
    const std::array<std::array<double, 2>, 4> in = {{{0, d}, {-w, 0}, {0, -d}, {w, 0}}};
    for (uint32_t c = 0; c < 4; ++c) {
        if (c >= notches) {
            corners.push_back(at[c]);
            continue;
        }
        const auto& a = in[c];
        const auto& b = in[(c + 1) % 4];
        corners.push_back({at[c][0] + a[0], at[c][1] + a[1]});
        corners.push_back({at[c][0] + a[0] - b[0], at[c][1] + a[1] - b[1]});
        corners.push_back({at[c][0] - b[0], at[c][1] - b[1]});
    }
    Ring ring;
    for (const auto& [u, v] : corners) {
        ring.points.push_back({static_cast<int32_t>(std::lround(x + u * std::cos(angle) - v * std::sin(angle))),
                               static_cast<int32_t>(std::lround(y + u * std::sin(angle) + v * std::cos(angle)))});
    }
    return ring;
}

/// Rows of houses along turned streets.
inline std::vector<Prism> make_town(uint32_t houses, uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<Prism> town;
    const auto pick = [&](uint32_t low, uint32_t count) { return static_cast<double>(low + random() % count); };
    for (uint32_t i = 0; i < houses; ++i) {
        const double street = i / 16, angle = 0.3 * static_cast<double>(static_cast<uint32_t>(street) % 7);
        const double x = 400 * (i % 16), y = 700 * street;
        Ring ring = turned_footprint(x, y, pick(100, 200), pick(100, 300), angle, random() % 4);
        town.push_back(make_prism({std::move(ring)}, 0, static_cast<int32_t>(pick(30, 60)) * 10, i % 5 == 0));
    }
    return town;
}

/// The same prisms with every coordinate as centimetres on the grid of 2^-10 m.
inline std::vector<Prism> in_centimetres(std::vector<Prism> prisms) {
    const auto place = [](int32_t& c) { c = static_cast<int32_t>(std::lround(c * 10.24)); };
    for (Prism& prism : prisms) {
        place(prism.base);
        place(prism.top);
        for (PrismWall& wall : prism.walls) place(wall.base);
        for (Ring& ring : prism.rings)
            for (auto& point : ring.points) {
                place(point[0]);
                place(point[1]);
            }
    }
    return prisms;
}

}  // namespace citystream::codec::mesh
