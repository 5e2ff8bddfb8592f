// Tiles for the tests of mesh layers, and what of a tile has to come back.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_tile.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "codec/mesh/triangle_plane.h"
#include "tests/codec/mesh/mesh_cases.h"

namespace citystream::codec::mesh {

/// Grey walls and brown roofs are told apart by z alone: what a builder does without pictures.
constexpr uint32_t kWallColour = colour_word({180, 180, 180}), kRoofColour = colour_word({120, 60, 40});

/// Flat triangles in colours.
inline MeshTile flat_tile(const GridMesh& mesh) {
    MeshTile tile;
    for (const auto& t : mesh.triangles) {
        const std::array<GridPoint, 3> places = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
        const Direction normal = plane_normal(places);
        for (const GridPoint& place : places) {
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back(
                {{place[0], place[1], place[2]},
                 {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])},
                 {0, 0}});
        }
        tile.triangle_chart.push_back(normal[2] * normal[2] < 0.25 ? kWallColour : kRoofColour);
    }
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    return tile;
}

/// Charts, texture coordinates as of a projection, smooth normals and dressed triangles here and there.
inline void dress_up(MeshTile& tile, uint32_t charts) {
    const auto count = static_cast<uint32_t>(tile.triangle_chart.size());
    tile.dressed_begin = count - count / 5;
    for (uint32_t t = 0; t < count; ++t) {
        if (t % 3 == 2) continue;
        tile.triangle_chart[t] = (t / 7) % charts;
        for (size_t k = 0; k < 3; ++k) {
            MeshVertex& vertex = tile.vertices[tile.indices[3 * size_t{t} + k]];
            vertex.texcoord[0] = vertex.position[0] * 3 + vertex.position[2];
            vertex.texcoord[1] = vertex.position[1] - 2 * vertex.position[2];
            if (t % 4 == 1) vertex.normal[k] += 0.4f;
        }
    }
}

/// A triangle by all that a layer says of it, turned to its least form.
using CornerFacts = std::tuple<GridPoint, uint64_t, std::array<int32_t, 2>>;  ///< place, normal code, texcoord
using TriangleFacts = std::tuple<std::array<CornerFacts, 3>, uint32_t, bool>;

inline std::vector<TriangleFacts> triangle_facts(const MeshTile& tile, uint32_t normal_bits) {
    std::vector<TriangleFacts> facts;
    for (uint32_t t = 0; t < tile.triangle_chart.size(); ++t) {
        std::array<CornerFacts, 3> corners;
        for (size_t k = 0; k < 3; ++k) {
            const MeshVertex& v = tile.vertices[tile.indices[3 * size_t{t} + k]];
            const Direction normal = {v.normal[0], v.normal[1], v.normal[2]};
            corners[k] = {{v.position[0], v.position[1], v.position[2]},
                          canonical_octahedral(pack_octahedral(normal, normal_bits), normal_bits),
                          {v.texcoord[0], v.texcoord[1]}};
        }
        auto least = corners;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            least = std::min(least, corners);
        }
        facts.emplace_back(least, tile.triangle_chart[t], t >= tile.dressed_begin);
    }
    std::sort(facts.begin(), facts.end());
    return facts;
}

}  // namespace citystream::codec::mesh
