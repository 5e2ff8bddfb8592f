#include "codec/mesh/local_strips.h"

#include <gtest/gtest.h>

#include "codec/mesh/local_strips_layout.h"
#include "tests/codec/damage.h"
#include "tests/codec/mesh/topology_meshes.h"
#include "tests/shaders/local_strips_on_cpu.h"

namespace citystream::codec::mesh {
namespace {

std::vector<std::pair<std::string, Topology>> local_topologies() {
    auto all = awkward_topologies();
    // Counts around a group of 64 and a block of 16 groups.
    for (const uint32_t count : {63u, 64u, 65u, 127u, 128u, 129u, 1023u, 1024u, 1025u})
        all.emplace_back("fan of " + std::to_string(count), fan(count));
    all.emplace_back("all apart", random_triangles(200, 1'000'000, 4));
    all.emplace_back("several blocks", with_edges_flipped(icosphere(5), 2000));
    return all;
}

TEST(LocalStrips, EveryTriangleComesBackInOrderWithItsOrientation) {
    for (const auto& [name, mesh] : local_topologies()) {
        SCOPED_TRACE(name);
        const auto code = encode_local_strips(mesh.triangles, mesh.vertices);
        ASSERT_TRUE(code.ok());
        const auto triangles = decode_local_strips(code->words);
        ASSERT_TRUE(triangles.ok()) << triangles.error().text();
        ASSERT_EQ(triangles->size(), mesh.triangles.size());
        std::vector<std::array<uint32_t, 3>> back;
        for (size_t i = 0; i < triangles->size(); ++i) {
            auto& corners = back.emplace_back((*triangles)[i]);
            for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
            EXPECT_EQ(corners, strip_corners(mesh.triangles, code->stream[i]));
        }
        EXPECT_EQ(canonical(back), canonical(mesh.triangles));
    }
}

TEST(LocalStrips, TheShaderReadsTheSameTrianglesFromABoundedNumberOfWords) {
    constexpr uint32_t kAt = 5;
    uint64_t most_loads = 0;
    for (const auto& [name, mesh] : local_topologies()) {
        SCOPED_TRACE(name);
        const auto code = encode_local_strips(mesh.triangles, mesh.vertices);
        std::vector<uint32_t> layer(kAt, 0xdeadbeefu);
        layer.insert(layer.end(), code->words.begin(), code->words.end());
        for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto triangle = shaders_test::local_triangle_on_cpu(layer, kAt, i);
            EXPECT_EQ(triangle.corners, local_triangle(code->words, i));
            most_loads = std::max(most_loads, triangle.loads);
        }
    }
    EXPECT_LE(most_loads, 33u);
}

TEST(LocalStrips, BitsPerTriangle) {
    const auto bits = [](const Topology& mesh) {
        return 32.0 * static_cast<double>(encode_local_strips(mesh.triangles, mesh.vertices)->words.size()) /
               static_cast<double>(mesh.triangles.size());
    };
    EXPECT_LE(bits(icosphere(6)), 4.6);
    EXPECT_LE(bits(quad_grid(200, 200, true)), 6.0);
    EXPECT_LE(bits(welded_boxes(2000)), 7.0);
    EXPECT_LE(bits(with_edges_flipped(icosphere(6), 6000)), 7.0);
}

TEST(LocalStrips, WordsAreLaidOutAsWritten) {
    // A quad and a triangle that touches it in a vertex: restart, P, restart; vertices 0 1 2 3, then an old one and two
    // new.
    const Topology mesh{{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}}, 6};
    const auto code = encode_local_strips(mesh.triangles, mesh.vertices);
    const std::vector<uint32_t> words = {LOCAL_STRIPS_MAGIC,
                                         3,
                                         6,
                                         13,  // header
                                         0,
                                         8,  // block: no vertex before, payload at word 8
                                         1u << LOCAL_STRIPS_RESTARTS_BIT,
                                         1,
                                         0,
                                         0,
                                         0b100,
                                         0,           // steps, restarts
                                         0b1101111};  // references; the field of 0 bits says vertex 1
    EXPECT_EQ(code->words, words);
}

TEST(LocalStrips, TheExampleOfTheFormatIsTrue) {
    const Topology box = welded_boxes(1);
    EXPECT_EQ(encode_local_strips(box.triangles, box.vertices)->words,
              (std::vector<uint32_t>{0x31534c43, 0x0000000a, 0x00000008, 0x0000000c, 0x00000000, 0x00000008, 0x22000000,
                                     0x00000000, 0x00000238, 0x00000000, 0x0000027f, 0x00000072}));
}

TEST(LocalStrips, TruncatedWordsAreRefused) {
    const Topology mesh = with_edges_flipped(icosphere(2), 100);
    const auto code = encode_local_strips(mesh.triangles, mesh.vertices);
    for (size_t count = 0; count < code->words.size(); ++count)
        EXPECT_FALSE(check_local_strips(exact_copy(std::span(code->words).first(count))).ok()) << count;
    auto longer = code->words;
    longer.push_back(0);
    EXPECT_FALSE(check_local_strips(longer).ok());
    ++longer[LOCAL_STRIPS_WORD_WORDS];
    EXPECT_FALSE(check_local_strips(longer).ok());
}

TEST(LocalStrips, DamagedWordsAreRefusedOrDecodeToVerticesThatExist) {
    size_t refused = 0, accepted = 0;
    for (const auto& mesh : {with_edges_flipped(icosphere(2), 40), random_triangles(100, 60, 1)}) {
        const auto code = encode_local_strips(mesh.triangles, mesh.vertices);
        for_each_mutation(code->words, [&](std::span<const uint32_t> words) {
            const auto triangles = decode_local_strips(words);
            ++(triangles.ok() ? accepted : refused);
            if (!triangles.ok()) return;
            for (uint32_t i = 0; i < triangles->size(); ++i) {
                for (const uint32_t vertex : (*triangles)[i]) EXPECT_LT(vertex, words[LOCAL_STRIPS_WORD_VERTICES]);
                EXPECT_EQ(shaders_test::local_triangle_on_cpu(words, 0, i).corners, (*triangles)[i]);
            }
        });
    }
    EXPECT_GT(refused, 1000u);
    EXPECT_GT(accepted, 10u) << "damage that no check can see was not tried";
}

}  // namespace
}  // namespace citystream::codec::mesh
