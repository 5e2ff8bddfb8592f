// Meshes without coordinates for the tests and the bench of the topology codecs: the synthetic set of the notes
// (spheres, tori, grids, edges flipped at random, hard-edged boxes) and what breaks careless codecs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace citystream::codec::mesh {

struct Topology {
    std::vector<std::array<uint32_t, 3>> triangles;
    uint32_t vertices = 0;
};

/// Number of an edge whose direction is not looked at, or is.
inline uint64_t directed_edge(uint32_t a, uint32_t b) {
    return uint64_t{a} << 32 | b;
}
inline uint64_t undirected_edge(uint32_t a, uint32_t b) {
    return directed_edge(std::min(a, b), std::max(a, b));
}

/// 20 * 4^level triangles; all vertices but twelve have six neighbours.
inline Topology icosphere(uint32_t level) {
    Topology mesh{{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                   {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                   {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}},
                  12};
    for (; level > 0; --level) {
        std::unordered_map<uint64_t, uint32_t> middles;
        std::vector<std::array<uint32_t, 3>> finer;
        const auto middle = [&](uint32_t a, uint32_t b) {
            const auto [found, is_new] = middles.try_emplace(undirected_edge(a, b), mesh.vertices);
            mesh.vertices += is_new ? 1 : 0;
            return found->second;
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const uint32_t x = middle(a, b), y = middle(b, c), z = middle(c, a);
            for (const auto& part : {std::array{a, x, z}, {x, b, y}, {z, y, c}, {x, y, z}}) finer.push_back(part);
        }
        mesh.triangles = std::move(finer);
    }
    return mesh;
}

/// A grid of width x height quads, each cut into two triangles; as a torus its sides are joined.
inline Topology quad_grid(uint32_t width, uint32_t height, bool torus) {
    Topology mesh{{}, torus ? width * height : (width + 1) * (height + 1)};
    const auto vertex = [&](uint32_t x, uint32_t y) {
        return torus ? y % height * width + x % width : y * (width + 1) + x;
    };
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

/// Tries `flips` times to turn a random edge, which makes the valences of its four vertices irregular.
inline Topology with_edges_flipped(Topology mesh, size_t flips) {
    auto& triangles = mesh.triangles;
    std::unordered_map<uint64_t, uint32_t> triangle_of;
    const auto add = [&](uint32_t t) {
        for (size_t c = 0; c < 3; ++c) triangle_of[directed_edge(triangles[t][c], triangles[t][(c + 1) % 3])] = t;
    };
    for (uint32_t t = 0; t < triangles.size(); ++t) add(t);
    std::mt19937 random(1);
    for (; flips > 0; --flips) {
        const auto t = static_cast<uint32_t>(random() % triangles.size());
        const size_t c = random() % 3;
        const uint32_t a = triangles[t][c], b = triangles[t][(c + 1) % 3], x = triangles[t][(c + 2) % 3];
        const auto other = triangle_of.find(directed_edge(b, a));
        if (other == triangle_of.end()) continue;
        const uint32_t u = other->second;
        const uint32_t y = triangles[u][0] ^ triangles[u][1] ^ triangles[u][2] ^ a ^ b;
        if (x == y || triangle_of.contains(directed_edge(x, y)) || triangle_of.contains(directed_edge(y, x))) continue;
        triangle_of.erase(directed_edge(a, b));
        triangle_of.erase(directed_edge(b, a));
        triangles[t] = {x, a, y};
        triangles[u] = {y, b, x};
        add(t);
        add(u);
    }
    return mesh;
}

/// Quads that share no vertex: boxes whose edges are hard.
inline Topology separate_quads(uint32_t count) {
    Topology mesh{{}, 4 * count};
    for (uint32_t v = 0; v < 4 * count; v += 4) {
        mesh.triangles.push_back({v, v + 1, v + 2});
        mesh.triangles.push_back({v, v + 2, v + 3});
    }
    return mesh;
}

/// Boxes without floors, each welded in itself.
inline Topology welded_boxes(uint32_t count) {
    constexpr uint32_t kFaces[5][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};
    Topology mesh{{}, 8 * count};
    for (uint32_t v = 0; v < 8 * count; v += 8) {
        for (const auto& [a, b, c, d] : kFaces) {
            mesh.triangles.push_back({v + a, v + b, v + c});
            mesh.triangles.push_back({v + a, v + c, v + d});
        }
    }
    return mesh;
}

inline Topology fan(uint32_t count) {
    Topology mesh{{}, count + 2};
    for (uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({0, i + 1, i + 2});
    return mesh;
}

inline Topology moebius_strip(uint32_t count) {
    Topology mesh{{}, count};
    for (uint32_t i = 0; i < count; ++i) {
        const std::array<uint32_t, 3> corners = {i, (i + 1) % count, (i + 2) % count};
        mesh.triangles.push_back(i % 2 == 0 ? corners : std::array{corners[1], corners[0], corners[2]});
    }
    return mesh;
}

/// Triangles with random corners: every kind of non-manifold, repeated and degenerate triangle at once.
inline Topology random_triangles(uint32_t count, uint32_t vertices, uint32_t seed) {
    Topology mesh{{}, vertices};
    std::mt19937 random(seed);
    const auto vertex = [&] { return static_cast<uint32_t>(random() % vertices); };
    for (uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({vertex(), vertex(), vertex()});
    return mesh;
}

inline std::vector<std::pair<std::string, Topology>> awkward_topologies() {
    return {{"empty", {}},
            {"vertices only", {{}, 5}},
            {"one triangle", {{{2, 0, 1}}, 3}},
            {"two apart", {{{0, 1, 2}, {3, 4, 5}}, 6}},
            {"two that touch in a vertex", {{{0, 1, 2}, {2, 3, 4}}, 5}},
            {"isolated vertices", {{{1, 5, 8}, {8, 5, 3}}, 12}},
            {"repeated", {{{0, 1, 2}, {1, 2, 0}, {0, 1, 2}}, 3}},
            {"both sides", {{{0, 1, 2}, {0, 2, 1}}, 3}},
            {"equal corners", {{{0, 0, 1}, {0, 1, 2}, {2, 2, 2}, {1, 0, 1}, {2, 1, 3}}, 4}},
            {"edge of three", {{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {4, 1, 5}}, 6}},
            {"edge of four", {{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}}, 6}},
            {"flipped neighbour", {{{0, 1, 2}, {1, 2, 3}, {2, 3, 4}}, 5}},
            {"bow tie", {{{0, 1, 2}, {0, 2, 3}, {0, 4, 5}, {0, 5, 6}}, 7}},
            {"Moebius strip, even", moebius_strip(20)},
            {"Moebius strip, odd", moebius_strip(21)},
            {"fan of 1000", fan(1000)},
            {"separate quads", separate_quads(50)},
            {"welded boxes", welded_boxes(50)},
            {"icosphere", icosphere(3)},
            {"torus", quad_grid(20, 13, true)},
            {"grid", quad_grid(20, 13, false)},
            {"flipped edges", with_edges_flipped(icosphere(4), 2000)},
            {"random, dense", random_triangles(500, 12, 1)},
            {"random, sparse", random_triangles(500, 400, 2)},
            {"random, mostly apart", random_triangles(300, 5000, 3)}};
}

/// Triangles turned to begin with their least corner, sorted: equal where the multisets of oriented triangles are.
/// Those with two equal corners can be left out.
inline std::vector<std::array<uint32_t, 3>> canonical(std::vector<std::array<uint32_t, 3>> triangles,
                                                      bool with_equal_corners = true) {
    if (!with_equal_corners)
        std::erase_if(triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    for (auto& corners : triangles) {
        auto turned = corners;
        for (int turn = 0; turn < 3; ++turn) {
            corners = std::min(corners, turned);
            std::rotate(turned.begin(), turned.begin() + 1, turned.end());
        }
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

}  // namespace citystream::codec::mesh
