// The border of a growing region: what waits, who follows whom, and what closes by itself.
#include "codec/mesh/mesh_border.h"

#include <gtest/gtest.h>

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kNone = MeshBorder::kNone;

MeshBorder border_of(uint32_t vertices) {
    MeshBorder border;
    for (uint32_t v = 0; v < vertices; ++v) border.add_vertex();
    return border;
}

/// Vertices along the loop of a gate, from its start.
std::vector<uint32_t> loop_of(const MeshBorder& border, uint32_t gate) {
    std::vector<uint32_t> vertices;
    for (uint32_t at = gate; vertices.size() < 100; at = border.gate(at).next) {
        vertices.push_back(border.gate(at).from);
        if (border.gate(at).next == gate) break;
    }
    return vertices;
}

TEST(MeshBorder, RunsAroundTheFirstTriangle) {
    MeshBorder border = border_of(3);
    border.start({0, 1, 2});
    const uint32_t gate = border.next_gate();
    ASSERT_NE(gate, kNone);
    EXPECT_EQ(loop_of(border, gate), (std::vector<uint32_t>{2, 0, 1}));
    EXPECT_EQ(border.gate(gate).opposite, 1u);
}

TEST(MeshBorder, GrowsByAnApexAndGoesOnAtItsRightEdge) {
    MeshBorder border = border_of(4);
    border.start({0, 1, 2});
    border.attach(border.next_gate(), 3);  // beyond 2 -> 0
    const uint32_t gate = border.next_gate();
    EXPECT_EQ(border.gate(gate).from, 3u);
    EXPECT_EQ(border.gate(gate).to, 0u);
    EXPECT_EQ(loop_of(border, gate), (std::vector<uint32_t>{3, 0, 1, 2}));
}

TEST(MeshBorder, ClosesATetrahedronWithoutBeingTold) {
    MeshBorder border = border_of(4);
    border.start({0, 1, 2});
    border.attach(border.next_gate(), 3);
    border.attach(border.next_gate(), 1);  // beyond 3 -> 0: edge 0 -> 1 closes
    EXPECT_TRUE(border.enclosed(0));
    border.attach(border.next_gate(), 2);  // the last face: all edges close
    EXPECT_EQ(border.next_gate(), kNone);
    for (uint32_t v = 0; v < 4; ++v) {
        EXPECT_TRUE(border.enclosed(v)) << v;
        EXPECT_EQ(border.vertex(v).triangles, 3u);
    }
}

TEST(MeshBorder, KeepsTheEdgeOfTheMeshInItsLoops) {
    MeshBorder border = border_of(3);
    border.start({0, 1, 2});
    for (int i = 0; i < 3; ++i) border.leave(border.next_gate());
    EXPECT_EQ(border.next_gate(), kNone);
    for (uint32_t v = 0; v < 3; ++v) EXPECT_FALSE(border.enclosed(v));
}

TEST(MeshBorder, SplitsALoopWhereTheApexIsOnIt) {
    MeshBorder border = border_of(6);
    border.start({0, 1, 2});
    border.attach(border.next_gate(), 3);  // loop 3 0 1 2
    border.attach(border.next_gate(), 4);  // beyond 3 -> 0: loop 4 0 1 2 3
    border.attach(border.next_gate(), 5);  // beyond 4 -> 0: loop 5 0 1 2 3 4
    const uint32_t gate = border.next_gate();
    border.attach(gate, 2);  // beyond 5 -> 0, on the far side
    const uint32_t right = border.next_gate();
    EXPECT_EQ(loop_of(border, right), (std::vector<uint32_t>{2, 0, 1}));
    EXPECT_EQ(loop_of(border, border.gate(gate).previous), (std::vector<uint32_t>{4, 5, 2, 3}));
}

}  // namespace
}  // namespace citystream::codec::mesh
