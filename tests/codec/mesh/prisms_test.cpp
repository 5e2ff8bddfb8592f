#include "codec/mesh/prisms.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/mesh_cases.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

/// The mesh of prisms, points not shared.
GridMesh mesh_of(std::vector<Prism> prisms) {
    return join({std::move(prisms), {}});
}
GridMesh both(GridMesh a, const GridMesh& b) {
    const auto first = static_cast<uint32_t>(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return a;
}
/// Splits, and fails when a triangle was lost or changed.
PrismSplit split_checked(const GridMesh& mesh) {
    const PrismSplit split = split_prisms(mesh);
    EXPECT_EQ(sorted_triangles(join(split)), sorted_triangles(mesh));
    return split;
}

TEST(Prisms, ABoxIsOnePrismAndNothingElse) {
    for (const bool floor : {false, true}) {
        const auto split = split_checked(mesh_of({make_prism({rectangle(0, 0, 10, 20)}, 3, 8, floor)}));
        ASSERT_EQ(split.prisms.size(), 1u);
        EXPECT_TRUE(split.remainder.triangles.empty());
        EXPECT_EQ(split.prisms[0].has_floor, floor);
        EXPECT_EQ(split.prisms[0].base, 3);
        EXPECT_EQ(split.prisms[0].top, 8);
        EXPECT_EQ(split.prisms[0].rings[0].points.size(), 4u);
    }
}

TEST(Prisms, BothDiagonalsAndMissingWallsAreKept) {
    Prism prism = make_prism({rectangle(0, 0, 10, 20)}, 0, 5);
    prism.walls = {{WallKind::kRising, 0}, {WallKind::kFalling, 0}, {WallKind::kOpen, 0}, {WallKind::kFalling, 0}};
    const auto split = split_checked(mesh_of({prism}));
    ASSERT_EQ(split.prisms.size(), 1u);
    EXPECT_TRUE(split.remainder.triangles.empty());
    EXPECT_EQ(split.prisms[0].walls, prism.walls);
}

TEST(Prisms, MostWallsMissingIsNoPrism) {
    Prism prism = make_prism({rectangle(0, 0, 10, 20)}, 0, 5);
    for (size_t i = 0; i < 3; ++i) prism.walls[i] = {WallKind::kOpen, 0};
    const auto split = split_checked(mesh_of({prism}));
    EXPECT_TRUE(split.prisms.empty());
    EXPECT_EQ(split.remainder.triangles.size(), 4u);
}

TEST(Prisms, AWallMayHaveABaseOfItsOwn) {
    Prism prism = make_prism({rectangle(0, 0, 10, 20)}, 0, 9);
    prism.walls[2].base = 4;
    const auto split = split_checked(mesh_of({prism}));
    ASSERT_EQ(split.prisms.size(), 1u);
    EXPECT_TRUE(split.remainder.triangles.empty());
    EXPECT_EQ(split.prisms[0].walls, prism.walls);
}

TEST(Prisms, CourtyardsAreRingsOfTheirPrism) {
    const auto split = split_checked(mesh_of(
        {make_prism({rectangle(0, 0, 100, 80), courtyard(10, 10, 20, 20), courtyard(50, 30, 30, 20)}, 0, 9, true)}));
    ASSERT_EQ(split.prisms.size(), 1u);
    EXPECT_TRUE(split.remainder.triangles.empty());
    ASSERT_EQ(split.prisms[0].rings.size(), 3u);
    EXPECT_TRUE(split.prisms[0].has_floor);
    const std::array<int32_t, 2> corner = {0, 0};
    EXPECT_NE(std::find(split.prisms[0].rings[0].points.begin(), split.prisms[0].rings[0].points.end(), corner),
              split.prisms[0].rings[0].points.end());
}

TEST(Prisms, HousesOfEqualHeightThatLeanOnEachOtherStayApart) {
    const auto split = split_checked(
        mesh_of({make_prism({rectangle(0, 0, 10, 20)}, 0, 9), make_prism({rectangle(10, 0, 12, 20)}, 0, 9)}));
    EXPECT_EQ(split.prisms.size(), 2u);
    EXPECT_TRUE(split.remainder.triangles.empty());
}

TEST(Prisms, StackedStoreysAreTheirOwnPrisms) {
    const auto split = split_checked(
        mesh_of({make_prism({rectangle(0, 0, 10, 20)}, 0, 9), make_prism({rectangle(0, 0, 10, 20)}, 9, 15, true),
                 make_prism({rectangle(2, 2, 5, 5)}, 15, 19)}));
    EXPECT_EQ(split.prisms.size(), 3u);
    EXPECT_TRUE(split.remainder.triangles.empty());
}

TEST(Prisms, WhatIsNoPrismStaysAsItIs) {
    // A gable roof on walls, a slope, a flat triangle twice, one without area, one looking down.
    GridMesh rest;
    rest.points = {{0, 0, 0}, {8, 0, 0}, {8, 6, 0}, {0, 6, 0}, {0, 3, 9}, {8, 3, 9}, {4, 4, 4}};
    rest.triangles = {{0, 1, 5}, {0, 5, 4}, {2, 3, 4}, {2, 4, 5}, {3, 0, 4}, {1, 2, 5},
                      {0, 1, 6}, {0, 1, 2}, {0, 1, 2}, {0, 0, 1}, {0, 2, 1}, {3, 3, 3}};
    const GridMesh mesh = both(rest, mesh_of({make_prism({rectangle(50, 0, 10, 20)}, 0, 9)}));
    const auto split = split_checked(mesh);
    EXPECT_EQ(split.prisms.size(), 1u);
    EXPECT_EQ(split.remainder.triangles.size(), rest.triangles.size());
}

TEST(Prisms, ATopWithAPointInsideStays) {
    GridMesh mesh = mesh_of({make_prism({rectangle(0, 0, 10, 20)}, 0, 9)});
    mesh.triangles.resize(8);  // the walls
    const auto middle = static_cast<uint32_t>(mesh.points.size());
    mesh.points.push_back({5, 10, 9});
    for (const auto& [x, y, u, v] : {std::array{0, 0, 10, 0}, {10, 0, 10, 20}, {10, 20, 0, 20}, {0, 20, 0, 0}}) {
        const auto first = static_cast<uint32_t>(mesh.points.size());
        mesh.points.push_back({x, y, 9});
        mesh.points.push_back({u, v, 9});
        mesh.triangles.push_back({first, first + 1, middle});
    }
    EXPECT_TRUE(split_checked(mesh).prisms.empty());
}

TEST(Prisms, AnEmptyMeshSplitsIntoNothing) {
    const auto split = split_checked({});
    EXPECT_TRUE(split.prisms.empty());
    EXPECT_TRUE(split.remainder.triangles.empty());
}

TEST(Prisms, ATownIsPrismsOnly) {
    const auto town = make_town(300, 1);
    const auto split = split_checked(mesh_of(town));
    EXPECT_EQ(split.prisms.size(), town.size());
    EXPECT_TRUE(split.remainder.triangles.empty());
}

TEST(Prisms, NoTriangleIsLostWhenEverythingIsSquashedTogether) {
    std::mt19937 random(3);
    for (int32_t unit : {7, 40, 150, 400}) {
        GridMesh mesh = mesh_of(make_town(200, 2));
        for (auto& p : mesh.points) p = {p[0] / unit, p[1] / unit, p[2] / unit};
        split_checked(mesh);
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
        split_checked(mesh);
    }
}

TEST(Prisms, WhereThousandsStandOnOneEdgeTheSearchEndsEarly) {
    constexpr size_t kCopies = 20'000;
    GridMesh box, mesh;
    add_box(box, {0, 0, 0}, {40, 30, 20});
    mesh.points = box.points;
    for (size_t i = 0; i < kCopies; ++i)
        mesh.triangles.insert(mesh.triangles.end(), box.triangles.begin(), box.triangles.end());
    const auto split = split_checked(mesh);
    EXPECT_GT(split.prisms.size(), 100u);
    EXPECT_LT(split.prisms.size(), kCopies / 2);
}

TEST(Prisms, NoTriangleOfARandomSoupIsLost) {
    std::mt19937 random(4);
    for (int round = 0; round < 200; ++round) {
        GridMesh mesh;
        for (int i = 0; i < 18; ++i)
            mesh.points.push_back({int32_t(random() % 3), int32_t(random() % 3), int32_t(random() % 2)});
        for (int i = 0; i < 150; ++i)
            mesh.triangles.push_back({uint32_t(random() % 18), uint32_t(random() % 18), uint32_t(random() % 18)});
        split_checked(mesh);
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
