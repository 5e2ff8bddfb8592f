// Surfaces written and read again without what a layer has besides: every triangle comes back, and topology and places
// take few bits.
#include "codec/mesh/surface_writer.h"

#include <gtest/gtest.h>

#include "codec/mesh/surface_reader.h"
#include "tests/codec/mesh/mesh_cases.h"

namespace citystream::codec::mesh {
namespace {

struct WrittenSurface {
    SurfaceBox box;
    std::vector<std::byte> bytes;
    double bits = 0, position_bits = 0;
};

WrittenSurface write(const GridMesh& mesh) {
    const WeldedSurface welded(mesh);
    WrittenSurface result{.box = box_of(welded, 0), .bytes = {}};
    bits::RangeEncoder encoder;
    SurfaceWriter writer(welded, result.box, 0);
    writer.write(encoder);
    result.bits = encoder.cost();
    result.position_bits = writer.walk().position_bits();
    result.bytes = encoder.finish();
    return result;
}

struct ReadSurface {
    Status status = Done{};
    GridMesh mesh;
};

ReadSurface read(const WrittenSurface& written, uint32_t most_points = ~0u, uint32_t most_triangles = ~0u) {
    bits::RangeDecoder decoder(written.bytes);
    SurfaceWalk walk(written.box.frame(most_points, most_triangles));
    Status status = read_surface(decoder, walk);
    if (status) status = decoder.finish();
    GridMesh mesh{walk.points(), walk.triangles()};
    for (GridPoint& point : mesh.points) {
        for (size_t k = 0; k < 3; ++k) point[k] += written.box.low[k];
    }
    return {status, std::move(mesh)};
}

double bits_a_triangle(const GridMesh& mesh) {
    return write(mesh).bits / static_cast<double>(mesh.triangles.size());
}

double topology_bits_a_triangle(const GridMesh& mesh) {
    const WrittenSurface written = write(mesh);
    return (written.bits - written.position_bits) / static_cast<double>(mesh.triangles.size());
}

TEST(SurfaceWriter, BringsEveryTriangleBackWithItsPlaceAndOrientation) {
    for (const MeshCase& c : awkward_meshes()) {
        const ReadSurface again = read(write(c.mesh));
        ASSERT_TRUE(again.status.ok()) << c.name << ": " << again.status.error().text();
        EXPECT_EQ(triangles_by_place(again.mesh), triangles_by_place(c.mesh)) << c.name;
    }
}

TEST(SurfaceWriter, SharesPointsThatAreAtOnePlaceAndDropsUnusedOnes) {
    GridMesh loose;
    for (const auto& corners : triangles_by_place(sphere_mesh(2, 1000))) {
        const auto first = static_cast<uint32_t>(loose.points.size());
        loose.points.insert(loose.points.end(), corners.begin(), corners.end());
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    loose.points.push_back({123, 456, 789});
    const ReadSurface again = read(write(loose));
    ASSERT_TRUE(again.status.ok());
    EXPECT_EQ(again.mesh.points.size(), 10u * 4 * 4 + 2);
    EXPECT_EQ(triangles_by_place(again.mesh), triangles_by_place(loose));
}

TEST(SurfaceWriter, TakesLessForTheSameThingAgain) {
    GridMesh windows;
    for (int32_t i = 0; i < 60; ++i) {
        GridMesh one = sphere_mesh(1, 777);
        const auto first = static_cast<uint32_t>(windows.points.size());
        for (const GridPoint& p : one.points) windows.points.push_back({p[0] + 2011 * i, p[1], p[2] + 37 * i});
        for (const auto& t : one.triangles) windows.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    EXPECT_LT(bits_a_triangle(windows), 2.0);
}

TEST(SurfaceWriter, SaysNearlyNothingAboutTheTopologyOfAnEvenMesh) {
    EXPECT_LT(topology_bits_a_triangle(sphere_mesh(5, 20000)), 0.1);
    EXPECT_LT(topology_bits_a_triangle(terrain_mesh(60)), 0.3);
}

TEST(SurfaceWriter, TakesTheSameForAShiftedMesh) {
    GridMesh mesh = terrain_mesh(40);
    const std::vector<std::byte> here = write(mesh).bytes;
    for (GridPoint& p : mesh.points) {
        for (int32_t& v : p) v -= 500'000'000;
    }
    EXPECT_EQ(write(mesh).bytes, here);
}

TEST(SurfaceWriter, StopsAtTheReadersLimits) {
    const GridMesh mesh = sphere_mesh(3, 1000);
    const WrittenSurface written = write(mesh);
    const auto points = static_cast<uint32_t>(mesh.points.size()),
               triangles = static_cast<uint32_t>(mesh.triangles.size());
    EXPECT_TRUE(read(written, points, triangles).status.ok());
    EXPECT_FALSE(read(written, points - 1, triangles).status.ok());
    EXPECT_FALSE(read(written, points, triangles - 1).status.ok());
}

}  // namespace
}  // namespace citystream::codec::mesh
