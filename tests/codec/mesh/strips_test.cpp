#include "codec/mesh/strips.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/topology_meshes.h"

namespace citystream::codec::mesh {
namespace {

constexpr StripTraversal kTraversals[] = {StripTraversal::kPivots, StripTraversal::kNewestPivots,
                                          StripTraversal::kBelts};

/// Whether every step says what it is documented to say.
void expect_steps_hold(const Topology& mesh, const StripOrder& order) {
    std::vector<uint32_t> times(mesh.triangles.size(), 0);
    std::array<uint32_t, 3> before{};
    for (size_t i = 0; i < order.triangles.size(); ++i) {
        const StripTriangle& place = order.triangles[i];
        ASSERT_LT(place.triangle, mesh.triangles.size());
        ASSERT_LT(place.rotation, 3);
        ++times[place.triangle];
        const auto corners = strip_corners(mesh.triangles, place);
        EXPECT_TRUE(i > 0 || place.step == StripStep::kRestart);
        if (place.step == StripStep::kPrevious) {
            EXPECT_EQ(corners[0], before[0]);
            EXPECT_EQ(corners[1], before[2]);
        } else if (place.step == StripStep::kNext) {
            EXPECT_EQ(corners[0], before[2]);
            EXPECT_EQ(corners[1], before[1]);
        }
        before = corners;
    }
    EXPECT_EQ(times, std::vector<uint32_t>(mesh.triangles.size(), 1)) << "not every triangle once";
}

size_t restarts(const StripOrder& order) {
    return static_cast<size_t>(std::count_if(order.triangles.begin(), order.triangles.end(),
                                             [](const auto& place) { return place.step == StripStep::kRestart; }));
}

TEST(Strips, EveryTriangleComesOnceAndFollowsTheOneBefore) {
    for (const auto& [name, mesh] : awkward_topologies()) {
        SCOPED_TRACE(name);
        for (const auto traversal : kTraversals)
            expect_steps_hold(mesh, order_strips(mesh.triangles, mesh.vertices, traversal));
    }
}

TEST(Strips, RegularSurfacesHardlyEverRestart) {
    const Topology sphere = icosphere(6), torus = quad_grid(200, 200, true);
    EXPECT_LE(restarts(order_strips(sphere.triangles, sphere.vertices)), 40u);
    EXPECT_LE(restarts(order_strips(torus.triangles, torus.vertices)), 200u) << "one a belt";
}

TEST(Strips, PiecesThatTouchInAnEdgeOfFourFacesKeepTheirStrips) {
    // Two welded boxes side by side share an edge of four faces: pairing by order keeps each in one piece.
    Topology boxes = welded_boxes(2);
    for (auto& corners : boxes.triangles) {
        for (uint32_t& vertex : corners) vertex = vertex == 8 ? 1 : vertex == 12 ? 5 : vertex;
    }
    const StripOrder order = order_strips(boxes.triangles, boxes.vertices);
    expect_steps_hold(boxes, order);
    EXPECT_LE(restarts(order), 2 * restarts(order_strips(welded_boxes(1).triangles, 8)) + 2);
}

TEST(Strips, TheOrderIsTheSameEveryTime) {
    const Topology mesh = with_edges_flipped(icosphere(4), 3000);
    EXPECT_EQ(order_strips(mesh.triangles, mesh.vertices).triangles,
              order_strips(mesh.triangles, mesh.vertices).triangles);
}

TEST(Strips, AHubOfManyTrianglesTakesNoQuadraticTime) {
    // 200,000 triangles that share nothing but one vertex: quadratic work would take minutes.
    Topology mesh{{}, 400'001};
    for (uint32_t i = 0; i < 200'000; ++i) mesh.triangles.push_back({0, 2 * i + 1, 2 * i + 2});
    for (const auto traversal : kTraversals)
        EXPECT_EQ(restarts(order_strips(mesh.triangles, mesh.vertices, traversal)), mesh.triangles.size());
}

TEST(Strips, VerticesAreNumberedByFirstUseAndUnusedOnesLast) {
    const Topology mesh{{{4, 2, 7}, {7, 2, 1}}, 8};
    const StripOrder order = order_strips(mesh.triangles, mesh.vertices);
    const auto vertices = order_of_first_use(mesh.triangles, order, mesh.vertices);
    ASSERT_EQ(vertices.size(), 8u);
    const auto first = strip_corners(mesh.triangles, order.triangles[0]);
    EXPECT_TRUE(std::equal(first.begin(), first.end(), vertices.begin()));
    EXPECT_EQ(std::vector(vertices.begin() + 4, vertices.end()), (std::vector<uint32_t>{0, 3, 5, 6}));
    const auto number = inverse_order(vertices);
    for (uint32_t i = 0; i < vertices.size(); ++i) EXPECT_EQ(number[vertices[i]], i);
}

}  // namespace
}  // namespace citystream::codec::mesh
