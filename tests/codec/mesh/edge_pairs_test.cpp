#include "codec/mesh/edge_pairs.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/topology_meshes.h"

namespace citystream::codec::mesh {
namespace {

size_t borders(const Topology& mesh) {
    const auto opposite = pair_edges(mesh.triangles, mesh.vertices);
    return static_cast<size_t>(std::count(opposite.begin(), opposite.end(), kNoEdge));
}

TEST(EdgePairs, PairsAreMutualAndRunAgainstEachOther) {
    for (const auto& [name, mesh] : awkward_topologies()) {
        SCOPED_TRACE(name);
        const auto opposite = pair_edges(mesh.triangles, mesh.vertices);
        ASSERT_EQ(opposite.size(), 3 * mesh.triangles.size());
        const auto from = [&](uint32_t edge) { return mesh.triangles[edge / 3][edge % 3]; };
        for (uint32_t edge = 0; edge < opposite.size(); ++edge) {
            const uint32_t other = opposite[edge];
            if (other == kNoEdge) continue;
            EXPECT_EQ(opposite[other], edge);
            EXPECT_NE(other / 3, edge / 3);
            EXPECT_EQ(from(edge), from(next_edge(other)));
            EXPECT_EQ(from(next_edge(edge)), from(other));
        }
    }
}

TEST(EdgePairs, OnlyBordersStayAlone) {
    EXPECT_EQ(borders(icosphere(2)), 0u);
    EXPECT_EQ(borders(quad_grid(7, 5, true)), 0u);
    EXPECT_EQ(borders(quad_grid(7, 5, false)), 2u * (7 + 5));
    EXPECT_EQ(borders(separate_quads(3)), 12u);
    EXPECT_EQ(borders(welded_boxes(2)), 8u) << "boxes have no floor";
    EXPECT_EQ(borders({{{0, 0, 1}, {1, 0, 0}}, 2}), 6u) << "triangles of equal corners have no neighbours";
}

TEST(EdgePairs, AnEdgeOfFourFacesPairsThoseThatCameTogether) {
    const Topology mesh{{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}}, 6};
    const auto opposite = pair_edges(mesh.triangles, mesh.vertices);
    EXPECT_EQ(opposite[0], 3u);
    EXPECT_EQ(opposite[6], 9u);
}

TEST(EdgePairs, CornersAroundAVertexAreAllItsCorners) {
    const Topology mesh = random_triangles(200, 30, 5);
    const VertexCorners around = corners_around(mesh.triangles, mesh.vertices);
    size_t count = 0;
    for (uint32_t vertex = 0; vertex < mesh.vertices; ++vertex) {
        for (const uint32_t corner : around.of(vertex)) EXPECT_EQ(mesh.triangles[corner / 3][corner % 3], vertex);
        count += around.of(vertex).size();
    }
    EXPECT_EQ(count, 3 * mesh.triangles.size());
}

}  // namespace
}  // namespace citystream::codec::mesh
