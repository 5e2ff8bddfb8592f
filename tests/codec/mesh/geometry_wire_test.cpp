// Meshes on the wire: every mesh comes back from every step, small, and nothing that bytes can make the decoder do.
#include "codec/mesh/geometry_wire.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/codec/mesh/mesh_cases.h"

namespace citystream::codec::mesh {
namespace {

using Bytes = std::vector<std::byte>;
using Spans = std::vector<std::span<const std::byte>>;

Spans first_steps(const GeometrySteps& coded, size_t count) {
    return Spans(coded.steps.begin(), coded.steps.begin() + static_cast<std::ptrdiff_t>(count));
}

GeometrySteps encode(const GridMesh& mesh, std::vector<uint32_t> dropped = {0}) {
    return encode_geometry(mesh, dropped);
}

size_t bytes_of(const GeometrySteps& coded) {
    size_t sum = 0;
    for (const Bytes& step : coded.steps) sum += step.size();
    return sum;
}

double bits_a_triangle(const GridMesh& mesh) {
    return 8.0 * static_cast<double>(bytes_of(encode(mesh))) / static_cast<double>(mesh.triangles.size());
}

double topology_bits_a_triangle(const GridMesh& mesh) {
    const GeometrySteps coded = encode(mesh);
    return (8.0 * static_cast<double>(bytes_of(coded)) - coded.position_bits) /
           static_cast<double>(mesh.triangles.size());
}

TEST(GeometryWire, BringsEveryTriangleBackWithItsPlaceAndOrientation) {
    for (const MeshCase& c : awkward_meshes()) {
        const auto coded = encode(c.mesh);
        const auto again = decode_geometry(first_steps(coded, 1));
        ASSERT_TRUE(again.ok()) << c.name << ": " << again.error().text();
        EXPECT_EQ(triangles_by_place(*again), triangles_by_place(c.mesh)) << c.name;
    }
}

TEST(GeometryWire, GivesEveryPrefixOfItsStepsWithTheBitsBelowCutOnTheGlobalGrid) {
    const std::vector<uint32_t> dropped = {9, 5, 4, 0};
    for (const MeshCase& c : awkward_meshes()) {
        const auto coded = encode(c.mesh, dropped);
        ASSERT_EQ(coded.steps.size(), dropped.size());
        for (size_t count = 1; count <= dropped.size(); ++count) {
            GridMesh cut = c.mesh;
            for (GridPoint& p : cut.points) {
                for (int32_t& v : p) v = (v >> dropped[count - 1]) * (1 << dropped[count - 1]);
            }
            const auto again = decode_geometry(first_steps(coded, count));
            ASSERT_TRUE(again.ok()) << c.name << ": " << again.error().text();
            EXPECT_EQ(triangles_by_place(*again), triangles_by_place(cut)) << c.name << " after " << count << " steps";
        }
    }
}

TEST(GeometryWire, SharesPointsThatAreAtOnePlaceAndDropsUnusedOnes) {
    GridMesh loose;
    for (const auto& corners : triangles_by_place(sphere_mesh(2, 1000))) {
        const auto first = static_cast<uint32_t>(loose.points.size());
        loose.points.insert(loose.points.end(), corners.begin(), corners.end());
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    loose.points.push_back({123, 456, 789});
    const auto again = decode_geometry(first_steps(encode(loose), 1));
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again->points.size(), 10u * 4 * 4 + 2);
    EXPECT_EQ(triangles_by_place(*again), triangles_by_place(loose));
}

TEST(GeometryWire, WritesTheSameBytesForTheSameMesh) {
    const GridMesh mesh = soup_mesh(200, 900, 1000, 5);
    EXPECT_EQ(encode(mesh, {3, 0}).steps, encode(mesh, {3, 0}).steps);
}

Bytes bytes_from(std::initializer_list<uint8_t> values) {
    Bytes bytes;
    for (const uint8_t value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

TEST(GeometryWire, KeepsTheBytesOfItsFormatPage) {
    const GridMesh mesh = {{{0, 0, 0}, {1024, 0, 0}, {1024, 1024, 512}}, {{0, 1, 2}}};
    EXPECT_EQ(encode(mesh).steps,
              (std::vector<Bytes>{bytes_from({0x01, 0x00, 0x58, 0x01, 0xdf, 0xa7, 0xd5, 0xbf, 0xff, 0x52, 0x80, 0x1d,
                                              0xb2, 0x8a, 0x31, 0x89, 0xd8, 0x90, 0x1f, 0x2c, 0x49, 0x93, 0xf6})}));
    EXPECT_EQ(encode(mesh, {6, 0}).steps,
              (std::vector<Bytes>{bytes_from({0x01, 0x26, 0x01, 0x3e, 0xe4, 0xfb, 0x05, 0x48, 0x01, 0xeb, 0xe0, 0xb3,
                                              0x62, 0x71, 0xd1, 0xac, 0x9d}),
                                  bytes_from({0xff, 0x78})}));
}

TEST(GeometryWire, TakesLessForTheSameThingAgain) {
    GridMesh windows;
    for (int32_t i = 0; i < 60; ++i) {
        GridMesh one = sphere_mesh(1, 777);
        const auto first = static_cast<uint32_t>(windows.points.size());
        for (const GridPoint& p : one.points) windows.points.push_back({p[0] + 2011 * i, p[1], p[2] + 37 * i});
        for (const auto& t : one.triangles) windows.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    EXPECT_LT(bits_a_triangle(windows), 2.0);
}

TEST(GeometryWire, SaysNearlyNothingAboutTheTopologyOfAnEvenMesh) {
    EXPECT_LT(topology_bits_a_triangle(sphere_mesh(5, 20000)), 0.1);
    EXPECT_LT(topology_bits_a_triangle(terrain_mesh(60)), 0.3);
}

TEST(GeometryWire, TakesLittleForBuiltThings) {
    // Edgebreaker with 16-bit positions takes about 40 bits a triangle for boxes that stand alone.
    EXPECT_LT(bits_a_triangle(town_mesh(30, 6)), 6.5);
}

TEST(GeometryWire, TakesPrismsApartWhereThatIsShorter) {
    EXPECT_GT(encode(town_mesh(10, 9)).prism_bits, 0);
    EXPECT_EQ(encode(sphere_mesh(3, 1000)).prism_bits, 0);
}

TEST(GeometryWire, TakesLessForAShiftedMeshThanForAnotherOne) {
    GridMesh mesh = terrain_mesh(40);
    const size_t here = bytes_of(encode(mesh));
    for (GridPoint& p : mesh.points) {
        for (int32_t& v : p) v -= 500'000'000;
    }
    EXPECT_LE(bytes_of(encode(mesh)), here + 12);
}

TEST(GeometryWire, NeedsEveryByte) {
    const GridMesh mesh = town_mesh(4, 7);
    const auto coded = encode(mesh, {4, 0});
    for (size_t step = 0; step < 2; ++step) {
        for (size_t size = 0; size < coded.steps[step].size(); ++size) {
            const Bytes cut(coded.steps[step].begin(), coded.steps[step].begin() + static_cast<std::ptrdiff_t>(size));
            Spans steps = first_steps(coded, 2);
            steps[step] = cut;
            const auto again = decode_geometry(steps);
            EXPECT_FALSE(again.ok() && triangles_by_place(*again) == triangles_by_place(mesh)) << step << " " << size;
        }
    }
}

TEST(GeometryWire, RefusesBytesThatFollowAndStepsThatWereNotAnnounced) {
    auto coded = encode(sphere_mesh(1, 100), {2, 0});
    Spans steps = first_steps(coded, 2);
    steps.push_back(coded.steps[1]);
    EXPECT_FALSE(decode_geometry(steps).ok());
    coded.steps[0].insert(coded.steps[0].end(), 9, std::byte{1});
    EXPECT_FALSE(decode_geometry(first_steps(coded, 1)).ok());
}

TEST(GeometryWire, StopsAtItsLimits) {
    const GridMesh mesh = sphere_mesh(3, 1000);
    const auto coded = encode(mesh);
    const auto points = static_cast<uint32_t>(mesh.points.size()),
               triangles = static_cast<uint32_t>(mesh.triangles.size());
    EXPECT_TRUE(decode_geometry(first_steps(coded, 1), {points, triangles}).ok());
    EXPECT_FALSE(decode_geometry(first_steps(coded, 1), {points - 1, triangles}).ok());
    EXPECT_FALSE(decode_geometry(first_steps(coded, 1), {points, triangles - 1}).ok());
}

TEST(GeometryWire, MakesAValidMeshOrAnErrorOfDamagedBytes) {
    std::mt19937 random(8);
    for (const MeshCase& c : awkward_meshes()) {
        const auto coded = encode(c.mesh, {4, 0});
        for (int i = 0; i < 60; ++i) {
            std::array<Bytes, 2> damaged = {coded.steps[0], coded.steps[1]};
            Bytes& step = damaged[random() % 4 == 0 ? 1 : 0];
            if (step.empty()) continue;
            for (uint32_t n = 1 + random() % 4; n > 0; --n)
                step[random() % step.size()] = static_cast<std::byte>(random());
            const Spans steps = {damaged[0], damaged[1]};
            const auto again = decode_geometry(steps, {20000, 20000});
            if (!again) continue;
            for (const auto& t : again->triangles) {
                for (const uint32_t v : t) ASSERT_LT(v, again->points.size()) << c.name;
            }
            for (const GridPoint& p : again->points) {
                for (const int32_t v : p) ASSERT_TRUE(v >= -(1 << 30) && v < 1 << 30) << c.name;
            }
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
