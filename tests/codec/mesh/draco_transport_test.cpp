#include "codec/mesh/draco_transport.h"

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "codec/mesh/draco_corners.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/mesh_triangles.h"
#include "tests/codec/mesh/mesh_tiles.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

/// A tile with all that a content can have.
MeshContent rich_content(float error = 0, uint32_t most_steps = 3) {
    MeshTile tile = flat_tile(town_mesh(5, 3));
    dress_up(tile, 4);
    MeshTile houses = flat_tile(join({make_town(20, 7), {}}));
    houses.dressed_begin = 0;
    for (MeshVertex& vertex : houses.vertices) vertex.position[0] -= 40'000;
    for (uint32_t i = 0; i < houses.indices.size(); ++i)
        tile.indices.push_back(houses.indices[i] + static_cast<uint32_t>(tile.vertices.size()));
    tile.vertices.insert(tile.vertices.end(), houses.vertices.begin(), houses.vertices.end());
    tile.triangle_chart.insert(tile.triangle_chart.begin(), houses.triangle_chart.begin(), houses.triangle_chart.end());
    // The houses' triangles come first: they are not dressed.
    std::rotate(tile.indices.begin(), tile.indices.end() - static_cast<std::ptrdiff_t>(houses.indices.size()),
                tile.indices.end());
    tile.dressed_begin += static_cast<uint32_t>(houses.triangle_chart.size());
    MeshContentOptions options;
    options.finest_error_metres = error;
    options.normal_bits = 10;
    options.most_steps = most_steps;
    options.topology = MeshTopology::kLocalStrips;
    return make_content(tile, options);
}

std::vector<TriangleFacts> facts_of(const MeshContent& content) {
    return triangle_facts(to_tile(content), content.normal_bits);
}

/// Ranks of prisms and of their points are the reader's own.
std::vector<std::tuple<std::vector<Corners>, uint32_t, uint32_t, uint32_t>> prisms_of(const MeshContent& content) {
    std::vector<std::tuple<std::vector<Corners>, uint32_t, uint32_t, uint32_t>> prisms;
    for (const MeshPrism& prism : content.prisms)
        prisms.emplace_back(sorted_triangles(join({{prism.shape}, {}})), prism.wall_chart, prism.top_chart,
                            prism.floor_chart);
    std::sort(prisms.begin(), prisms.end());
    return prisms;
}

void expect_comes_back(const MeshContent& content) {
    const auto wire = encode_draco_mesh(content);
    ASSERT_TRUE(wire) << wire.error().text();
    ASSERT_EQ(1u, wire->steps.size());
    EXPECT_TRUE(is_draco_mesh(wire->steps[0]));
    const auto back = decode_draco_mesh(wire->steps[0]);
    ASSERT_TRUE(back) << back.error().text();
    EXPECT_EQ(std::vector{content.dropped.back()}, back->dropped);
    EXPECT_EQ(content.normal_bits, back->normal_bits);
    EXPECT_EQ(content.topology, back->topology);
    EXPECT_EQ(facts_of(content), facts_of(*back));
    EXPECT_EQ(back->points, wire->content.points);
    EXPECT_EQ(back->triangles, wire->content.triangles);
    EXPECT_EQ(back->points.size(), std::set<GridPoint>(back->points.begin(), back->points.end()).size());
}

TEST(DracoTransport, BringsBackAllOfATile) {
    for (const float error : {0.0f, 0.5f}) {
        const MeshContent content = rich_content(error);
        ASSERT_FALSE(content.prisms.empty());
        ASSERT_FALSE(content.triangles.empty());
        expect_comes_back(content);
    }
}

TEST(DracoTransport, FindsThePrismsThatTravelledAsTriangles) {
    for (const float error : {0.0f, 0.5f}) {
        const MeshContent content = rich_content(error);
        ASSERT_GT(content.prisms.size(), 15u);
        const auto wire = encode_draco_mesh(content);
        ASSERT_TRUE(wire);
        EXPECT_EQ(prisms_of(content), prisms_of(wire->content));
        EXPECT_EQ(content.triangles.size(), wire->content.triangles.size());
        EXPECT_EQ(content.points.size(), wire->content.points.size());
    }
}

/// A triangle as a vertex shader has it, turned to its least form: places, normals and texture coordinates of corners.
/// Those that fill up prisms with fewer points than their range, at two corners in one place, show nothing.
using SeenCorner = std::array<std::array<int32_t, 3>, 3>;
using SeenTriangle = std::tuple<std::array<SeenCorner, 3>, uint32_t, bool>;

std::vector<SeenTriangle> seen_triangles(const std::vector<uint32_t>& words) {
    const auto view = ResidentMeshView::create(words, 100);
    EXPECT_TRUE(view) << view.error().text();
    std::vector<SeenTriangle> seen;
    for (uint32_t t = 0; view && t < view->triangle_count(); ++t) {
        std::array<SeenCorner, 3> corners{};
        for (uint32_t k = 0; k < 3; ++k) {
            const ResidentCorner corner = view->corner(t, k, {});
            corners[k] = {corner.position, corner.normal, {}};
            view->texcoord(t, k, corners[k][2].data());
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        if (corners[0][0] == corners[1][0] || corners[1][0] == corners[2][0] || corners[2][0] == corners[0][0])
            continue;
        seen.emplace_back(corners, view->chart_word(t), view->dressed(t));
    }
    std::sort(seen.begin(), seen.end());
    return seen;
}

TEST(DracoTransport, WhatIsKeptAndDrawnIsThatOfTheOtherTransport) {
    for (const float error : {0.0f, 0.5f}) {
        const MeshContent content = rich_content(error, 1);
        const auto wire = encode_draco_mesh(content);
        ASSERT_TRUE(wire);
        const std::vector<uint32_t> words = make_resident(wire->content).with_steps(1);
        const std::vector<uint32_t> others = make_resident(encode_mesh_wire(content).content).with_steps(1);
        const auto seen = seen_triangles(words);
        EXPECT_GT(seen.size(), 600u);
        EXPECT_TRUE(seen_triangles(others) == seen);
        // Orders differ, and with them how strips run and which faces follow each other.
        EXPECT_NEAR(1.0, static_cast<double>(words.size()) / static_cast<double>(others.size()), 0.03);
    }
}

TEST(DracoTransport, NeverLosesATriangleOfAwkwardMeshes) {
    for (MeshCase& c : awkward_meshes()) {
        SCOPED_TRACE(c.name);
        for (GridPoint& point : c.mesh.points) {
            for (int32_t& part : point) part = std::clamp(part, -(1 << 20), 1 << 20);
        }
        MeshTile tile = flat_tile(c.mesh);
        expect_comes_back(make_content(tile));
        dress_up(tile, 3);
        expect_comes_back(make_content(tile));
    }
}

TEST(DracoTransport, MeshesThatAreTooWideGoTheOtherWay) {
    GridMesh mesh{{{0, 0, 0}, {1 << 22, 0, 0}, {0, 5, 0}}, {{0, 1, 2}}};
    EXPECT_FALSE(encode_draco_mesh(make_content(flat_tile(mesh))));
    mesh.points[1][0] -= 1;
    expect_comes_back(make_content(flat_tile(mesh)));
}

TEST(DracoTransport, KeepsTextureCoordinatesOfTheWidestRange) {
    MeshTile tile = flat_tile(soup_mesh(60, 100, 1 << 12, 9));
    std::mt19937 random(4);
    for (uint32_t t = 0; t < 100; ++t) {
        tile.triangle_chart[t] = t % 3;
        for (size_t k = 0; k < 3; ++k) {
            for (int32_t& part : tile.vertices[tile.indices[3 * size_t{t} + k]].texcoord)
                part = t % 3 == 0 ? static_cast<int32_t>(random()) : static_cast<int32_t>(random() % 0x20000);
        }
    }
    expect_comes_back(make_content(tile));
}

TEST(DracoTransport, SendsABoxInFewBytes) {
    GridMesh mesh;
    add_box(mesh, {0, 0, 0}, {10'000, 20'000, 30'000});
    const auto wire = encode_draco_mesh(make_content(flat_tile(mesh)));
    ASSERT_TRUE(wire);
    EXPECT_LT(wire->steps[0].size(), 250u);
}

TEST(DracoTransport, EveryTruncationIsAnError) {
    const auto wire = encode_draco_mesh(rich_content());
    ASSERT_TRUE(wire);
    const std::span<const std::byte> bytes = wire->steps[0];
    for (size_t size = 0; size < bytes.size(); size += size < 400 ? 1 : 37)
        EXPECT_FALSE(decode_draco_mesh(bytes.first(size))) << size;
    std::vector<std::byte> longer(bytes.begin(), bytes.end());
    longer.push_back(std::byte{0});
    EXPECT_FALSE(decode_draco_mesh(longer));
}

TEST(DracoTransport, MutatedBytesGiveAnErrorOrSoundContent) {
    const auto wire = encode_draco_mesh(rich_content());
    ASSERT_TRUE(wire);
    std::mt19937 random(8);
    uint32_t errors = 0;
    constexpr uint32_t kMutations = 600;
    for (uint32_t i = 0; i < kMutations; ++i) {
        std::vector<std::byte> bytes = wire->steps[0];
        for (uint32_t change = 0; change <= i % 3; ++change) {
            const size_t reach = i % 2 == 0 ? std::min<size_t>(bytes.size(), 120) : bytes.size();
            bytes[random() % reach] = static_cast<std::byte>(random());
        }
        const auto content = decode_draco_mesh(bytes, {20'000, 10'000});
        errors += content ? 0 : 1;
        if (!content) continue;
        EXPECT_LE(content->points.size(), 20'000u);
        EXPECT_LE(content->triangles.size(), 10'000u);
        for (const MeshTriangle& triangle : content->triangles) {
            for (const MeshCorner& corner : triangle.corners) {
                ASSERT_LT(corner.point, content->points.size());
                ASSERT_LT(corner.normal, 1u << 2 * content->normal_bits);
            }
        }
        for (const GridPoint& point : content->points) {
            for (const int32_t c : point) ASSERT_LT(std::abs(int64_t{c}), 1 << 30);
        }
    }
    EXPECT_GT(errors, kMutations / 4);
}

TEST(DracoTransport, LimitsAndClaimsAreCheckedBeforeRoomIsMade) {
    const MeshContent content = rich_content();
    const auto wire = encode_draco_mesh(content);
    ASSERT_TRUE(wire);
    const auto triangles = static_cast<uint32_t>(triangle_count(content));
    std::set<GridPoint> places;
    for_each_triangle(content, [&places](const PlacedTriangle& triangle) {
        places.insert(triangle.places.begin(), triangle.places.end());
    });
    const auto points = static_cast<uint32_t>(places.size());
    EXPECT_TRUE(decode_draco_mesh(wire->steps[0], {points, triangles}));
    EXPECT_FALSE(decode_draco_mesh(wire->steps[0], {points - 1, triangles}));
    EXPECT_FALSE(decode_draco_mesh(wire->steps[0], {points, triangles - 1}));

    std::vector<DracoCorner> corners(3);
    corners[1].place = {5, 0, 0};
    corners[2].place = {0, 5, 0};
    for (const DracoMethod method : {DracoMethod::kEdgebreaker, DracoMethod::kSequential}) {
        const auto bytes = encode_draco_corners(corners, method);
        ASSERT_TRUE(bytes);
        EXPECT_TRUE(decode_draco_corners(*bytes, 1));
        EXPECT_FALSE(decode_draco_corners(*bytes, 2)) << "another number of triangles";
        // From here on the bytes claim 2^28 triangles or points, or 255 groups of attributes.
        for (size_t at = 11; at < 16; ++at) {
            std::vector<std::byte> claim = *bytes;
            for (size_t i = at; i < at + 4; ++i) claim[i] = std::byte{0xff};
            EXPECT_FALSE(decode_draco_corners(claim, 1)) << at;
        }
    }
}

TEST(DracoTransport, BytesOfTheOtherTransportAreNotTaken) {
    const auto other = encode_mesh_wire(rich_content());
    EXPECT_FALSE(is_draco_mesh(other.steps[0]));
    EXPECT_FALSE(decode_draco_mesh(other.steps[0]));
    EXPECT_FALSE(decode_draco_mesh({}));
}

}  // namespace
}  // namespace citystream::codec::mesh
