// What draws know of mesh layers, against the view of the same words; and how prisms share their vertices.
#include "client/render/mesh_draws.h"

#include <gtest/gtest.h>

#include <set>

#include "client/render/prism_indices.h"
#include "tests/codec/mesh/resident_contents.h"

namespace citystream::client {
namespace {

using namespace codec::mesh;

std::vector<uint32_t> layer_words(bool constrained, uint32_t steps) {
    const ContentKind kind{.topology = MeshTopology::kLocalStrips, .constrained = constrained};
    return make_resident(random_content(terrain_mesh(12), kind, 7)).with_steps(steps);
}

TEST(MeshDraws, AreThoseOfTheLayersRanges) {
    for (const bool constrained : {false, true}) {
        const std::vector<uint32_t> words = layer_words(constrained, 2);
        const Result<ResidentMeshView> view = ResidentMeshView::create(words, 5);
        ASSERT_TRUE(view.ok());
        const std::vector<MeshDrawConstants> draws = mesh_draw_constants(words);
        ASSERT_EQ(draws.size(), view->ranges().size());
        uint32_t first = 0, prisms = 0;
        for (size_t r = 0; r < draws.size(); ++r) {
            const MeshRange& range = view->ranges()[r];
            EXPECT_EQ(draws[r].form & 0xffff, range.kind | range.flags << 8);
            EXPECT_EQ((draws[r].form & MESH_FORM_BINS) != 0, view->positions().shape().bins.size() > 1);
            EXPECT_EQ(draws[r].first_triangle, first);
            EXPECT_EQ(draws[r].topology, range.topology_begin);
            first += range.triangles;
            if (range.kind != RESIDENT_KIND_PRISMS) continue;
            ++prisms;
            EXPECT_EQ(range.triangles % draws[r].triangles, 0u);
            EXPECT_LT(draws[r].vertices, 3 * draws[r].triangles);
        }
        EXPECT_GT(prisms, 1u);
    }
}

TEST(MeshDraws, FollowTheLayersLevel) {
    const std::vector<uint32_t> words = layer_words(false, 1), refined = layer_words(false, 3);
    MeshDraws known;
    known.learn(3, words);
    EXPECT_FALSE(known.is_partial(3));
    const std::vector<MeshDrawConstants> wanted = mesh_draw_constants(refined);
    EXPECT_NE(known.of(3, 0).level, wanted[0].level);
    known.set_level(3, wanted[0].level);
    for (uint32_t r = 0; r < wanted.size(); ++r) {
        EXPECT_EQ(known.of(3, r).level, wanted[r].level);
        EXPECT_EQ(known.of(3, r).form, wanted[r].form);
        EXPECT_EQ(known.of(3, r).positions_at, wanted[r].positions_at);
    }
    known.forget(3);
    EXPECT_EQ(known.of(3, 0).triangles, 0u);
}

TEST(MeshDraws, EveryBeginningOfALayerIsTakenAsItIs) {
    const std::vector<uint32_t> words = layer_words(true, 1);
    const size_t ranges = mesh_draw_constants(words).size();
    MeshDraws known;
    bool was_partial = true;
    for (size_t count = 1; count <= words.size(); ++count) {
        const auto begin = std::span(words).first(count);
        EXPECT_LE(mesh_draw_constants(begin).size(), ranges);
        known.learn(0, begin);
        EXPECT_LE(known.is_partial(0), was_partial) << count;
        was_partial = known.is_partial(0);
    }
    EXPECT_FALSE(was_partial);
    known.learn(0, std::vector<uint32_t>{1, 2, 3});
    EXPECT_FALSE(known.is_partial(0)) << "no mesh layer";
    EXPECT_EQ(known.of(0, 0).form, 0u);
}

TEST(PrismIndices, TrianglesOfAWallShareTwoVerticesAndNoOthersAny) {
    constexpr uint32_t kPoints = 5, kTriangles = 2 * 5 + 2 * 3, kPrisms = 3;
    const std::vector<uint32_t> indices = prism_indices(kPoints, kTriangles, kPrisms);
    ASSERT_EQ(indices.size(), 3u * kTriangles * kPrisms);
    constexpr uint32_t kVertices = 4 * kPoints + 3 * (kTriangles - 2 * kPoints);
    EXPECT_EQ(std::set(indices.begin(), indices.end()).size(), kVertices * kPrisms);
    for (uint32_t prism = 0; prism < kPrisms; ++prism) {
        const uint32_t* const of_prism = &indices[3u * kTriangles * prism];
        for (uint32_t wall = 0; wall < kPoints; ++wall) {
            const uint32_t first = kVertices * prism + 4 * wall;
            const std::vector<uint32_t> wanted = {first, first + 1, first + 2, first, first + 2, first + 3};
            EXPECT_EQ(std::vector<uint32_t>(of_prism + 6 * wall, of_prism + 6 * wall + 6), wanted);
        }
        for (uint32_t i = 6 * kPoints; i < 3 * kTriangles; ++i)
            EXPECT_EQ(of_prism[i], kVertices * prism + 4 * kPoints + i - 6 * kPoints);
    }
}

}  // namespace
}  // namespace citystream::client
