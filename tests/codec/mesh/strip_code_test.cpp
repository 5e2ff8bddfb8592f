#include "codec/mesh/strip_code.h"

#include <gtest/gtest.h>

#include <cmath>

#include "codec/mesh/strip_layout.h"
#include "tests/codec/damage.h"
#include "tests/codec/mesh/topology_meshes.h"

namespace citystream::codec::mesh {
namespace {

double bits_per_triangle(const StripCode& code, const Topology& mesh) {
    return 32.0 * static_cast<double>(code.words.size()) / static_cast<double>(mesh.triangles.size());
}

double bits_per_triangle(const Topology& mesh, const StripCodeOptions& options = {}) {
    return bits_per_triangle(*encode_strips(mesh.triangles, mesh.vertices, options), mesh);
}

/// Vertices with six triangles around them, as a share of all.
double regular_share(const Topology& mesh) {
    std::vector<uint32_t> valence(mesh.vertices, 0);
    for (const auto& corners : mesh.triangles) {
        for (const uint32_t vertex : corners) ++valence[vertex];
    }
    return static_cast<double>(std::count(valence.begin(), valence.end(), 6u)) / mesh.vertices;
}

/// A sphere of 327,680 triangles, `share` of whose vertices are regular, to a hundredth.
Topology irregular_sphere(double share) {
    const std::pair<double, size_t> flips[] = {{1.0, 0}, {0.80, 9'700}, {0.60, 24'400}, {0.29, 90'000}};
    for (const auto& [its_share, count] : flips) {
        if (its_share != share) continue;
        Topology mesh = with_edges_flipped(icosphere(7), count);
        EXPECT_NEAR(regular_share(mesh), share, 0.01);
        return mesh;
    }
    ADD_FAILURE() << "no sphere of that share";
    return {};
}

constexpr uint32_t kModes[] = {STRIP_MODE_RESTARTS, STRIP_MODE_DEGENERATES};

TEST(StripCode, EveryTriangleComesBackWithItsOrientationInBothModesAndPredictions) {
    for (const auto& [name, mesh] : awkward_topologies()) {
        for (const uint32_t mode : kModes) {
            for (const uint32_t prediction : {0u, 1u}) {
                SCOPED_TRACE(name + ", mode " + std::to_string(mode) + ", prediction " + std::to_string(prediction));
                const auto code = encode_strips(mesh.triangles, mesh.vertices, {mode, prediction, {}});
                ASSERT_TRUE(code.ok());
                EXPECT_TRUE(check_strip_code(code->words).ok());
                auto triangles = decode_strips(code->words);
                ASSERT_TRUE(triangles.ok()) << triangles.error().text();
                EXPECT_EQ(*decode_strips_staged(code->words), *triangles);
                ASSERT_EQ(code->vertices.size(), mesh.vertices);
                for (auto& corners : *triangles) {
                    for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
                }
                const bool exact = mode == STRIP_MODE_RESTARTS;
                EXPECT_EQ(canonical(*triangles, exact), canonical(mesh.triangles, exact));
            }
        }
    }
}

TEST(StripCode, TheStreamSaysWhichInputTriangleEveryTriangleIs) {
    for (const auto& [name, mesh] : awkward_topologies()) {
        SCOPED_TRACE(name);
        const auto code = encode_strips(mesh.triangles, mesh.vertices);
        const auto triangles = decode_strips(code->words);
        ASSERT_EQ(triangles->size(), code->stream.size());
        for (size_t i = 0; i < triangles->size(); ++i) {
            auto corners = (*triangles)[i];
            for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
            if (code->stream[i].triangle == kPutIn) {
                EXPECT_TRUE(canonical({corners}, false).empty()) << "a triangle put in can be seen";
            } else {
                EXPECT_EQ(corners, strip_corners(mesh.triangles, code->stream[i]));
            }
        }
    }
}

TEST(StripCode, UnforcedCodeIsTheSmallestAndKeepsTrianglesWithEqualCorners) {
    for (const auto& [name, mesh] : awkward_topologies()) {
        SCOPED_TRACE(name);
        const bool has_equal_corners = canonical(mesh.triangles, false).size() != mesh.triangles.size();
        size_t fewest = SIZE_MAX;
        for (const uint32_t mode : kModes) {
            if (mode == STRIP_MODE_DEGENERATES && has_equal_corners) continue;
            for (const uint32_t prediction : {0u, 1u}) {
                for (const auto traversal :
                     {StripTraversal::kPivots, StripTraversal::kNewestPivots, StripTraversal::kBelts}) {
                    const auto forced = encode_strips(mesh.triangles, mesh.vertices, {mode, prediction, traversal});
                    fewest = std::min(fewest, forced->words.size());
                }
            }
        }
        const auto code = encode_strips(mesh.triangles, mesh.vertices);
        EXPECT_EQ(code->words.size(), fewest);
        auto triangles = *decode_strips(code->words);
        for (auto& corners : triangles) {
            for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
        }
        EXPECT_EQ(canonical(triangles, has_equal_corners), canonical(mesh.triangles, has_equal_corners));
    }
}

TEST(StripCode, BitsPerTriangleOnTheSyntheticSet) {
    // Both modes by one traversal: an encoder that tries all never takes more.
    const auto bits = [](const Topology& mesh) { return bits_per_triangle(mesh, {{}, {}, StripTraversal::kPivots}); };
    EXPECT_LE(bits_per_triangle(icosphere(8), {STRIP_MODE_DEGENERATES, 1u, StripTraversal::kPivots}), 3.1);
    EXPECT_LE(bits(quad_grid(700, 700, true)), 3.3);
    EXPECT_LE(bits(separate_quads(10'000)), 4.1) << "hard-edged boxes";
    EXPECT_LE(bits(irregular_sphere(0.80)), 4.0);
    EXPECT_LE(bits(irregular_sphere(0.60)), 5.1);
    EXPECT_LE(bits(irregular_sphere(0.29)), 7.5);
}

TEST(StripCode, PivotsTakeFewerBitsThanTheBeltsOfThePaper) {
    const auto both = [](const Topology& mesh, double at_least) {
        const double pivots = bits_per_triangle(mesh, {{}, {}, StripTraversal::kPivots});
        EXPECT_LE(pivots, (1 - at_least) * bits_per_triangle(mesh, {{}, {}, StripTraversal::kBelts}));
    };
    both(irregular_sphere(0.80), 0.05);
    both(irregular_sphere(0.29), 0.08);
    both(welded_boxes(1000), 0.15);
}

TEST(StripCode, HalfOfTheReferencesAreNewAndSimple9HalvesTheRest) {
    for (const double share : {1.0, 0.8, 0.6}) {
        const Topology mesh = irregular_sphere(share);
        const auto code =
            encode_strips(mesh.triangles, mesh.vertices, {STRIP_MODE_RESTARTS, 1u, StripTraversal::kPivots});
        const StripHeader header = *read_strip_header(code->words);
        const double explicit_share = static_cast<double>(header.explicit_references) / header.references;
        EXPECT_GE(explicit_share, 0.49) << share;
        EXPECT_LE(explicit_share, 0.56) << share;
        const double fixed_width = std::ceil(std::log2(mesh.vertices)) * header.explicit_references;
        EXPECT_GE(fixed_width / (32.0 * header.code_words), 2.0) << share;
    }
}

TEST(StripCode, ARestartBesideTheTriangleBeforePutsInTwoTriangles) {
    // Three triangles around vertex 0 that share no edge.
    const Topology mesh{{{0, 1, 2}, {0, 3, 4}, {5, 0, 6}}, 7};
    const auto code = encode_strips(mesh.triangles, mesh.vertices, {STRIP_MODE_DEGENERATES, {}, {}});
    EXPECT_EQ(read_strip_header(code->words)->triangles, 3u + 2 * 2);
    const Topology apart{{{0, 1, 2}, {3, 4, 5}}, 6};
    const auto other = encode_strips(apart.triangles, apart.vertices, {STRIP_MODE_DEGENERATES, {}, {}});
    EXPECT_EQ(read_strip_header(other->words)->triangles, 2u + 4);
}

TEST(StripCode, WordsAreLaidOutAsWritten) {
    // A quad: the first triangle leaves by its third edge, the second is (v0, v2, new).
    const Topology mesh{{{0, 1, 2}, {0, 2, 3}}, 4};
    const auto code = encode_strips(mesh.triangles, mesh.vertices, {STRIP_MODE_RESTARTS, 0u, {}});
    EXPECT_EQ(code->words, (std::vector<uint32_t>{STRIP_MAGIC, 2, 4, 0, 0, STRIP_MODE_RESTARTS, 4, 0, 0b1111, 0b0010}));
    const auto one_bit = encode_strips(mesh.triangles, mesh.vertices, {STRIP_MODE_DEGENERATES, 0u, {}});
    EXPECT_EQ(one_bit->words,
              (std::vector<uint32_t>{STRIP_MAGIC, 2, 4, 0, 0, STRIP_MODE_DEGENERATES, 4, 0, 0b1111, 0}));
}

TEST(StripCode, TheExampleOfTheFormatIsTrue) {
    const Topology box = welded_boxes(1);
    EXPECT_EQ(encode_strips(box.triangles, box.vertices)->words,
              (std::vector<uint32_t>{0x31545343, 0x0000000a, 0x0000000c, 0x00000004, 0x00000001, 0x00000000, 0x00000008,
                                     0x00000000, 0x00018143, 0x0000027f, 0x00040542}));
}

TEST(StripCode, GreatestDifferencesFitTheirWords) {
    // The last triangle goes back to the first vertices and forth again.
    constexpr uint32_t kVertices = 300'000;
    Topology mesh{{}, kVertices};
    for (uint32_t v = 0; v + 2 < kVertices; v += 3) mesh.triangles.push_back({v, v + 1, v + 2});
    mesh.triangles.push_back({0, kVertices - 1, 1});
    const auto code = encode_strips(mesh.triangles, mesh.vertices);
    auto triangles = *decode_strips(code->words);
    for (auto& corners : triangles) {
        for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
    }
    EXPECT_EQ(canonical(triangles, false), canonical(mesh.triangles));
    EXPECT_FALSE(encode_strips({}, STRIP_MOST_VERTICES + 1).ok());
    EXPECT_TRUE(encode_strips({}, 1u << 20).ok());
}

TEST(StripCode, TruncatedWordsAreRefused) {
    const Topology mesh = with_edges_flipped(icosphere(2), 100);
    for (const uint32_t mode : kModes) {
        const auto code = encode_strips(mesh.triangles, mesh.vertices, {mode, {}, {}});
        for (size_t count = 0; count < code->words.size(); ++count)
            EXPECT_FALSE(check_strip_code(exact_copy(std::span(code->words).first(count))).ok()) << count;
        auto longer = code->words;
        longer.push_back(0);
        EXPECT_FALSE(check_strip_code(longer).ok());
    }
}

TEST(StripCode, DamagedWordsAreRefusedOrDecodeToVerticesThatExist) {
    const Topology mesh = with_edges_flipped(icosphere(1), 40);
    size_t refused = 0, accepted = 0;
    for (const uint32_t mode : kModes) {
        const auto code = encode_strips(mesh.triangles, mesh.vertices, {mode, {}, {}});
        for_each_mutation(code->words, [&](std::span<const uint32_t> words) {
            const auto triangles = decode_strips(words);
            EXPECT_EQ(check_strip_code(words).ok(), triangles.ok());
            ++(triangles.ok() ? accepted : refused);
            if (!triangles.ok()) return;
            for (const auto& corners : *triangles) {
                for (const uint32_t vertex : corners) EXPECT_LT(vertex, words[STRIP_WORD_VERTICES]);
            }
            EXPECT_EQ(*decode_strips_staged(words), *triangles);
        });
    }
    EXPECT_GT(refused, 1000u);
    EXPECT_GT(accepted, 10u) << "damage that no check can see was not tried";
}

TEST(StripCode, EveryPaddingBitIsLookedAt) {
    const Topology mesh{{{0, 1, 2}, {0, 2, 3}}, 4};
    const auto code = encode_strips(mesh.triangles, mesh.vertices, {STRIP_MODE_RESTARTS, 0u, {}});
    for (const auto& [word, used] : {std::pair{8, 4}, std::pair{9, 4}}) {
        for (int bit = used; bit < 32; ++bit) {
            auto words = code->words;
            words[static_cast<size_t>(word)] |= 1u << bit;
            EXPECT_FALSE(check_strip_code(words).ok()) << "word " << word << ", bit " << bit;
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
