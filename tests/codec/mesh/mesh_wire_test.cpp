// Mesh layers on the wire: every content comes back from every prefix of its steps, small, and nothing that bytes can
// make the reader do.
#include "codec/mesh/mesh_wire.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/codec/mesh/mesh_contents.h"

namespace citystream::codec::mesh {
namespace {

using Bytes = std::vector<std::byte>;
using Spans = std::vector<std::span<const std::byte>>;

Spans first_steps(const MeshWire& wire, size_t count) {
    return Spans(wire.steps.begin(), wire.steps.begin() + static_cast<std::ptrdiff_t>(count));
}

double bits_a_triangle(const MeshContent& content) {
    size_t bytes = 0;
    for (const Bytes& step : encode_mesh_wire(content).steps) bytes += step.size();
    return 8.0 * static_cast<double>(bytes) / static_cast<double>(content.triangles.size());
}

/// One colour, normals of planes as a reader reckons them for flat faces.
MeshContent plain_content(const GridMesh& mesh) {
    MeshContent content = dressed_content(mesh, 1);
    for (MeshTriangle& t : content.triangles) {
        t.chart_word = colour_word({200, 200, 200});
        t.dressed = false;
        for (MeshCorner& c : t.corners) c = {.point = c.point, .normal = 0, .texcoord = {}};
    }
    return content;
}

TEST(MeshWire, BringsEveryContentBackFromEveryPrefixOfItsSteps) {
    for (const ContentCase& c : awkward_contents()) {
        const MeshWire wire = encode_mesh_wire(c.content);
        ASSERT_EQ(wire.steps.size(), c.content.dropped.size());
        for (size_t count = 1; count <= wire.steps.size(); ++count) {
            const auto again = decode_mesh_wire(first_steps(wire, count));
            ASSERT_TRUE(again.ok()) << c.name << ": " << again.error().text();
            EXPECT_EQ(again->dropped, c.content.dropped);
            EXPECT_EQ(again->normal_bits, c.content.normal_bits);
            EXPECT_EQ(again->topology, c.content.topology);
            EXPECT_EQ(told_triangles(*again, count - 1), told_triangles(c.content, count - 1)) << c.name << count;
            EXPECT_EQ(told_prisms(*again, count - 1), told_prisms(c.content, count - 1)) << c.name << count;
        }
    }
}

TEST(MeshWire, TellsWhatItsReaderWillHave) {
    for (const ContentCase& c : awkward_contents()) {
        const MeshWire wire = encode_mesh_wire(c.content);
        const auto again = decode_mesh_wire(first_steps(wire, wire.steps.size()));
        ASSERT_TRUE(again.ok()) << c.name;
        EXPECT_EQ(again->points, wire.content.points) << c.name;
        EXPECT_EQ(again->triangles, wire.content.triangles) << c.name;
        EXPECT_EQ(again->most_dropped, wire.content.most_dropped) << c.name;
        ASSERT_EQ(again->prisms.size(), wire.content.prisms.size()) << c.name;
        for (size_t i = 0; i < again->prisms.size(); ++i) {
            const MeshPrism &a = again->prisms[i], &b = wire.content.prisms[i];
            EXPECT_EQ(a.wall_chart, b.wall_chart);
            EXPECT_EQ(a.shape.top_triangles, b.shape.top_triangles);
            EXPECT_EQ(a.shape.walls, b.shape.walls);
            EXPECT_EQ(a.shape.rings[0].points, b.shape.rings[0].points);
        }
    }
}

TEST(MeshWire, KeepsOrderCountsAndAttributesWhateverTheNumberOfSteps) {
    for (const ContentCase& c : awkward_contents()) {
        const MeshWire wire = encode_mesh_wire(c.content);
        for (size_t count = 1; count <= wire.steps.size(); ++count) {
            const auto again = decode_mesh_wire(first_steps(wire, count));
            ASSERT_TRUE(again.ok()) << c.name;
            EXPECT_EQ(again->triangles, wire.content.triangles) << c.name << count;
            EXPECT_EQ(again->points.size(), wire.content.points.size());
        }
    }
}

TEST(MeshWire, LeavesUnknownBitsZeroAndNoStepEmpty) {
    MeshContent content = plain_content({{{1024, 2048, 4096}, {4096, 2048, 1024}, {1024, 1024, 0}}, {{0, 1, 2}}});
    content.dropped = {9, 6, 3, 0};
    const MeshWire wire = encode_mesh_wire(content);
    for (const Bytes& step : wire.steps) EXPECT_FALSE(step.empty());
    const auto again = decode_mesh_wire(first_steps(wire, 2));
    ASSERT_TRUE(again.ok());
    for (const GridPoint& p : again->points)
        for (const int32_t v : p) EXPECT_EQ(v % 64, 0);
}

TEST(MeshWire, GivesLimitedPointsTheirBitsInTheFirstStep) {
    MeshContent content = plain_content(town_mesh(4, 6));
    for (GridPoint& p : content.points)
        for (int32_t& v : p) v = v * 8 + 5;
    content.dropped = {8, 5};
    content.most_dropped.assign(content.points.size(), 6);
    const auto again = decode_mesh_wire(first_steps(encode_mesh_wire(content), 1));
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(told_triangles(*again, 0), told_triangles(content, 0));
    uint32_t low = 0;
    for (const GridPoint& p : again->points) {
        for (const int32_t v : p) {
            EXPECT_EQ(v % 64, 0);
            low |= static_cast<uint32_t>(v);
        }
    }
    EXPECT_NE(low & 0xc0, 0u);  // bits 6 and 7 are known though the step drops 8
}

TEST(MeshWire, WritesTheSameBytesForTheSameContent) {
    const MeshContent content = prism_content(12);
    EXPECT_EQ(encode_mesh_wire(content).steps, encode_mesh_wire(content).steps);
}

Bytes bytes_from(std::initializer_list<uint8_t> values) {
    Bytes bytes;
    for (const uint8_t value : values) bytes.push_back(static_cast<std::byte>(value));
    return bytes;
}

TEST(MeshWire, KeepsTheBytesOfItsFormatPage) {
    MeshContent content;
    content.points = {{0, 0, 0}, {1024, 0, 0}, {1024, 1024, 512}};
    MeshTriangle triangle;
    for (uint32_t i = 0; i < 3; ++i)
        triangle.corners[i] = {.point = i, .normal = 0x7fb0, .texcoord = {i > 0 ? 65536 : 0, i > 1 ? 65536 : 0}};
    content.triangles = {triangle};
    content.prisms = {{make_prism({rectangle(0, 0, 4096, 8192)}, 0, 3072), colour_word({200, 190, 180}),
                       colour_word({90, 60, 50}), 0}};
    content.dropped = {6, 0};
    EXPECT_EQ(encode_mesh_wire(content).steps,
              (std::vector<Bytes>{bytes_from({0x01, 0x4c, 0x07, 0x2f, 0xf3, 0xa2, 0xec, 0x09, 0xa0, 0x03, 0xd3, 0x05,
                                              0x59, 0xd1, 0xa6, 0x5f, 0x00, 0x00, 0x00, 0x00, 0x00, 0x41, 0x26, 0xa6,
                                              0xb7, 0x5d, 0x6e, 0x56, 0x7c, 0xf0, 0xf5, 0x42, 0x7a, 0xed, 0x2d, 0x4f,
                                              0x86, 0xc0, 0xa0, 0x68, 0xbd, 0xdb, 0xc4, 0xae, 0xb8, 0x48, 0x3b}),
                                  bytes_from({0x1a, 0xb8, 0x68, 0x0a, 0x87, 0xea, 0x37})}));
}

TEST(MeshWire, TakesNextToNothingForAttributesThatFollow) {
    // One colour for all, and pieces of charts whose coordinates are those of the places.
    MeshContent content = plain_content(terrain_mesh(40));
    const double plain = bits_a_triangle(content);
    for (size_t i = 0; i < content.triangles.size(); ++i) {
        MeshTriangle& t = content.triangles[i];
        t.chart_word = static_cast<uint32_t>(i / 780);
        t.dressed = i % 1560 < 780;
        for (MeshCorner& c : t.corners) c.texcoord = {content.points[c.point][0] * 2, content.points[c.point][1] * 2};
    }
    EXPECT_LT(bits_a_triangle(content), plain + 1);
}

TEST(MeshWire, TakesLittleForBuiltThings) {
    // Edgebreaker with 16-bit positions takes about 40 bits a triangle for boxes that stand alone.
    const GridMesh town = town_mesh(30, 6);
    const PrismSplit split = split_prisms(town);
    MeshContent content = plain_content(split.remainder);
    for (const Prism& prism : split.prisms)
        content.prisms.push_back(
            {prism, colour_word({1, 2, 3}), colour_word({4, 5, 6}), prism.has_floor ? colour_word({7, 8, 9}) : 0});
    EXPECT_FALSE(content.prisms.empty());
    const MeshWire wire = encode_mesh_wire(content);
    EXPECT_LT(8.0 * static_cast<double>(wire.steps[0].size()), 6.5 * static_cast<double>(town.triangles.size()));
}

TEST(MeshWire, NeedsEveryByte) {
    MeshContent content = prism_content(5);
    content.dropped = {4, 0};
    const MeshWire wire = encode_mesh_wire(content);
    for (size_t step = 0; step < 2; ++step) {
        for (size_t size = 0; size < wire.steps[step].size(); ++size) {
            Spans steps = first_steps(wire, 2);
            steps[step] = steps[step].first(size);
            const auto again = decode_mesh_wire(steps);
            EXPECT_FALSE(again.ok() && told_triangles(*again, 1) == told_triangles(content, 1) &&
                         told_prisms(*again, 1) == told_prisms(content, 1))
                << step << " " << size;
        }
    }
}

TEST(MeshWire, RefusesBytesThatFollowAndStepsThatWereNotAnnounced) {
    MeshContent content = plain_content(sphere_mesh(1, 100));
    content.dropped = {2, 0};
    MeshWire wire = encode_mesh_wire(content);
    Spans steps = first_steps(wire, 2);
    steps.push_back(wire.steps[1]);
    EXPECT_FALSE(decode_mesh_wire(steps).ok());
    wire.steps[0].insert(wire.steps[0].end(), 9, std::byte{1});
    EXPECT_FALSE(decode_mesh_wire(first_steps(wire, 1)).ok());
}

TEST(MeshWire, StopsAtItsLimits) {
    const MeshContent content = prism_content(6);
    const MeshWire wire = encode_mesh_wire(content);
    auto points = static_cast<uint32_t>(wire.content.points.size()),
         triangles = static_cast<uint32_t>(wire.content.triangles.size());
    for (const MeshPrism& prism : content.prisms) {
        const Prism& shape = prism.shape;
        points += static_cast<uint32_t>(2 * shape.walls.size());
        triangles +=
            static_cast<uint32_t>(2 * shape.walls.size() + shape.top_triangles.size() + shape.floor_triangles.size());
    }
    EXPECT_TRUE(decode_mesh_wire(first_steps(wire, 1), {points, triangles}).ok());
    EXPECT_FALSE(decode_mesh_wire(first_steps(wire, 1), {points - 1, triangles}).ok());
    EXPECT_FALSE(decode_mesh_wire(first_steps(wire, 1), {points, triangles - 1}).ok());
}

void expect_valid(const MeshContent& content, const std::string& name) {
    for (const MeshTriangle& t : content.triangles) {
        for (const MeshCorner& c : t.corners) {
            ASSERT_LT(c.point, content.points.size()) << name;
            ASSERT_EQ(c.normal >> (2 * content.normal_bits), 0u) << name;
        }
        ASSERT_TRUE(is_chart_word(t.chart_word, CHART_WORD_COLOUR)) << name;
    }
    for (const GridPoint& p : content.points) {
        for (const int32_t v : p) ASSERT_TRUE(v >= -(1 << 30) && v < 1 << 30) << name;
    }
    for (const MeshPrism& prism : content.prisms) {
        ASSERT_TRUE(names_colour(prism.wall_chart) && names_colour(prism.top_chart)) << name;
        ASSERT_LE(prism.shape.base, prism.shape.top) << name;
        ASSERT_TRUE(std::abs(prism.shape.base) < 1 << 30 && std::abs(prism.shape.top) < 1 << 30) << name;
    }
    for (const uint8_t most : content.most_dropped) ASSERT_LE(most, kMeshGridBits) << name;
}

TEST(MeshWire, MakesAValidContentOrAnErrorOfDamagedBytes) {
    std::mt19937 random(8);
    for (const ContentCase& c : awkward_contents()) {
        const MeshWire wire = encode_mesh_wire(c.content);
        for (int i = 0; i < 60; ++i) {
            std::vector<Bytes> damaged(wire.steps);
            Bytes& step = damaged[random() % 3 == 0 ? damaged.size() - 1 : 0];
            for (uint32_t n = 1 + random() % 4; n > 0; --n)
                step[random() % step.size()] = static_cast<std::byte>(random());
            const auto again = decode_mesh_wire(Spans(damaged.begin(), damaged.end()), {20000, 20000});
            if (again) expect_valid(*again, c.name);
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
