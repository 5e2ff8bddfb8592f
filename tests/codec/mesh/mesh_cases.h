// Meshes that a geometry codec has to bring back: awkward ones, built ones and grown ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "codec/mesh/grid_mesh.h"
#include "tests/codec/mesh/triangles_by_place.h"

namespace citystream::codec::mesh {

struct MeshCase {
    std::string name;
    GridMesh mesh;
};

/// A sphere of 20 * 4^level triangles.
inline GridMesh sphere_mesh(uint32_t level, double radius) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<std::array<double, 3>> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                                 {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                                 {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<uint32_t, 3>> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (uint32_t l = 0; l < level; ++l) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(points.size()));
            if (fresh)
                points.push_back(
                    {points[a][0] + points[b][0], points[a][1] + points[b][1], points[a][2] + points[b][2]});
            const double length = std::hypot(points[at->second][0], points[at->second][1], points[at->second][2]);
            for (double& c : points[at->second]) c /= length;
            return at->second;
        };
        std::vector<std::array<uint32_t, 3>> finer;
        for (const auto& t : triangles) {
            const uint32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            finer.insert(finer.end(), {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
        }
        triangles = std::move(finer);
    }
    GridMesh mesh{{}, triangles};
    for (auto& p : points) {
        const double length = std::hypot(p[0], p[1], p[2]);
        GridPoint place{};
        for (size_t c = 0; c < 3; ++c) place[c] = static_cast<int32_t>(std::lround(p[c] / length * radius));
        mesh.points.push_back(place);
    }
    return mesh;
}

/// A closed box; appended.
inline void add_box(GridMesh& mesh, const GridPoint& low, const GridPoint& size) {
    const auto first = static_cast<uint32_t>(mesh.points.size());
    for (int i = 0; i < 8; ++i)
        mesh.points.push_back(
            {low[0] + (i & 1 ? size[0] : 0), low[1] + (i & 2 ? size[1] : 0), low[2] + (i & 4 ? size[2] : 0)});
    constexpr uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
    for (const auto& f : kFaces) {
        mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
        mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
}

/// Boxes on plots, some wall to wall.
inline GridMesh town_mesh(int side, uint32_t seed) {
    std::mt19937 random(seed);
    GridMesh mesh;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const bool touching = random() % 3 == 0;
            const int32_t width = touching ? 20000 : 10000 + static_cast<int32_t>(random() % 8000);
            add_box(mesh, {x * 20000, y * 30000, 0}, {width, 15000, 3000 * (1 + static_cast<int32_t>(random() % 9))});
        }
    }
    return mesh;
}

/// A height field of side x side points with a border.
inline GridMesh terrain_mesh(uint32_t side) {
    GridMesh mesh;
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            const double height = 3000 * std::sin(x * 0.11) * std::cos(y * 0.07) + 500 * std::sin(x * 0.7 + y);
            mesh.points.push_back(
                {static_cast<int32_t>(x * 1024), static_cast<int32_t>(y * 1024), static_cast<int32_t>(height)});
            if (x == 0 || y == 0) continue;
            const uint32_t d = y * side + x, c = d - 1, b = d - side, a = b - 1;
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
        }
    }
    return mesh;
}

/// Triangles over random points: nothing manifold about it.
inline GridMesh soup_mesh(uint32_t points, uint32_t triangles, uint32_t spread, uint32_t seed) {
    std::mt19937 random(seed);
    GridMesh mesh;
    const auto coordinate = [&] { return static_cast<int32_t>(random() % spread) - static_cast<int32_t>(spread / 2); };
    for (uint32_t i = 0; i < points; ++i) {
        const int32_t x = coordinate(), y = coordinate(), z = coordinate();
        mesh.points.push_back({x, y, z});
    }
    for (uint32_t i = 0; i < triangles; ++i) {
        const auto a = static_cast<uint32_t>(random() % points), b = static_cast<uint32_t>(random() % points);
        mesh.triangles.push_back({a, b, static_cast<uint32_t>(random() % points)});
    }
    return mesh;
}

/// What an encoder is most likely to get wrong.
inline std::vector<MeshCase> awkward_meshes() {
    const std::vector<GridPoint> places = {{0, 0, 0}, {9, 0, 0},  {0, 9, 0},   {9, 9, 1},
                                           {5, 5, 9}, {-7, 3, 2}, {30, 30, 30}};
    std::vector<MeshCase> cases = {
        {"nothing", {}},
        {"points without triangles", {places, {}}},
        {"one triangle", {places, {{0, 1, 2}}}},
        {"two triangles apart", {places, {{0, 1, 2}, {3, 4, 5}}}},
        {"two triangles back to back", {places, {{0, 1, 2}, {2, 1, 0}}}},
        {"a triangle twice and turned", {places, {{0, 1, 2}, {0, 1, 2}, {1, 2, 0}}}},
        {"a flipped neighbour", {places, {{0, 1, 2}, {1, 2, 3}}}},
        {"an edge of five faces", {places, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}, {0, 1, 6}}}},
        {"a bow tie", {places, {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}}}},
        {"equal corners", {places, {{0, 0, 1}, {0, 1, 2}, {3, 3, 3}, {4, 5, 4}, {6, 4, 4}}}},
        {"equal corners only", {places, {{5, 5, 5}, {1, 0, 0}, {0, 1, 0}}}},
        {"the largest coordinates",
         {{{(1 << 30) - 1, -(1 << 30) + 1, 0},
           {-(1 << 30) + 1, (1 << 30) - 1, 0},
           {0, 0, (1 << 30) - 1},
           {0, 0, -(1 << 30) + 1}},
          {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}}}},
        {"all points at one place", {{{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}, {{0, 1, 2}}}},
    };
    GridMesh moebius, fan{{{0, 0, 50}}, {}};
    for (int i = 0; i < 20; ++i) {
        const double turn = i * 6.283185307 / 20;
        for (const double w : {-20.0, 20.0}) {
            const double r = 100 + w * std::cos(turn / 2);
            moebius.points.push_back({static_cast<int32_t>(r * std::cos(turn)),
                                      static_cast<int32_t>(r * std::sin(turn)),
                                      static_cast<int32_t>(w * std::sin(turn / 2))});
        }
        const auto a = static_cast<uint32_t>(2 * i), b = a + 1, c = i < 19 ? a + 2 : 1, d = i < 19 ? a + 3 : 0;
        moebius.triangles.insert(moebius.triangles.end(), {{a, c, b}, {b, c, d}});
    }
    for (uint32_t i = 0; i < 1000; ++i) {
        const double turn = i * 6.283185307 / 1000;
        fan.points.push_back(
            {static_cast<int32_t>(9000 * std::cos(turn)), static_cast<int32_t>(9000 * std::sin(turn)), 0});
        fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % 1000});
    }
    GridMesh torn = sphere_mesh(2, 500), twice = sphere_mesh(1, 300);
    for (size_t t = 0; t < torn.triangles.size(); t += 3) std::swap(torn.triangles[t][0], torn.triangles[t][1]);
    const auto copy = twice.triangles;
    twice.triangles.insert(twice.triangles.end(), copy.begin(), copy.end());
    cases.push_back({"a Moebius strip", std::move(moebius)});
    cases.push_back({"a fan of a thousand", std::move(fan)});
    cases.push_back({"a sphere with every third face turned over", std::move(torn)});
    cases.push_back({"a sphere twice", std::move(twice)});
    cases.push_back({"a soup", soup_mesh(60, 400, 200, 1)});
    cases.push_back({"a wide soup", soup_mesh(300, 300, 1u << 30, 2)});
    cases.push_back({"a dense soup", soup_mesh(500, 3000, 9, 3)});
    cases.push_back({"a town", town_mesh(8, 4)});
    cases.push_back({"a terrain", terrain_mesh(30)});
    GridMesh mixed = terrain_mesh(40);
    for (int32_t i = 0; i < 30; ++i) add_box(mixed, {i * 1200, (i * 700) % 9000, 2000 + i}, {900, 800 + i, 5000});
    cases.push_back({"boxes on a terrain", std::move(mixed)});
    return cases;
}

}  // namespace citystream::codec::mesh
