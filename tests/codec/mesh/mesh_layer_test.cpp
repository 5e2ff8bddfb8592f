#include "codec/mesh/mesh_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_layout.h"
#include "codec/mesh/octahedral.h"
#include "tests/codec/damage.h"

namespace citystream::codec::mesh {
namespace {

struct Prefix {
    std::vector<uint32_t> words;
    std::vector<uint32_t> step_words;
};

Prefix prefix_of(const LayerSteps& steps, size_t count) {
    Prefix prefix;
    for (size_t s = 0; s < count; ++s) {
        prefix.words.insert(prefix.words.end(), steps[s].words.begin(), steps[s].words.end());
        prefix.step_words.push_back(static_cast<uint32_t>(steps[s].words.size()));
    }
    return prefix;
}

MeshVertex vertex_at(int32_t x, int32_t y, int32_t z, int32_t u = 0, int32_t v = 0) {
    return {{x, y, z}, {0, 0, 1}, {u, v}};
}

MeshTile one_triangle() {
    MeshTile tile;
    tile.vertices = {vertex_at(0, 0, 0), vertex_at(1024, 0, 0, 65536, 0), vertex_at(0, 1024, 512, 0, 65536)};
    tile.indices = {0, 1, 2};
    tile.triangle_chart = {0};
    return tile;
}

MeshTile random_tile(uint32_t seed, int32_t span) {
    std::mt19937 random(seed);
    const auto coordinate = [&] { return static_cast<int32_t>(random() % static_cast<uint32_t>(2 * span + 1)) - span; };
    MeshTile tile;
    for (int i = 0; i < 300; ++i) {
        MeshVertex vertex =
            vertex_at(coordinate(), coordinate(), coordinate(), coordinate() % 30000, coordinate() % 30000);
        for (float& c : vertex.normal) c = static_cast<float>(coordinate()) / static_cast<float>(span);
        tile.vertices.push_back(vertex);
    }
    for (int t = 0; t < 500; ++t) {
        for (int c = 0; c < 3; ++c) tile.indices.push_back(static_cast<uint32_t>(random() % tile.vertices.size()));
        tile.triangle_chart.push_back(static_cast<uint32_t>(3 * (random() % 5)));
    }
    tile.dressed_begin = 400;
    return tile;
}

/// Largest distance between the corners of a tile and of a decoded prefix, in metres; checks all other attributes on
/// the way.
double compare_corners(const MeshTile& tile, const MeshTile& decoded) {
    EXPECT_EQ(decoded.indices.size(), tile.indices.size());
    EXPECT_EQ(decoded.triangle_chart, tile.triangle_chart);
    EXPECT_EQ(decoded.dressed_begin, tile.dressed_begin);
    double worst = 0;
    for (size_t i = 0; i < tile.indices.size(); ++i) {
        const MeshVertex& want = tile.vertices[tile.indices[i]];
        const MeshVertex& got = decoded.vertices[decoded.indices[i]];
        double square = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = (want.position[c] - got.position[c]) / 1024.0;
            square += d * d;
        }
        worst = std::max(worst, std::sqrt(square));
        float normal[3];
        unpack_octahedral16(pack_octahedral16(want.normal), normal);
        for (int c = 0; c < 3; ++c) EXPECT_EQ(got.normal[c], normal[c]);
        for (int c = 0; c < 2; ++c) EXPECT_EQ(got.texcoord[c], want.texcoord[c]);
    }
    return worst;
}

TEST(MeshLayer, AllStepsGiveBackTheTileExactlyWhenTheGeometryHasNoError) {
    for (const int32_t span : {30000, 1 << 20, 1 << 28}) {
        const MeshTile tile = random_tile(1, span);
        const LayerSteps steps = encode_mesh(tile, 0);
        ASSERT_EQ(steps.size(), 3u);
        const Prefix prefix = prefix_of(steps, 3);
        const auto decoded = decode_mesh(prefix.words, prefix.step_words, 13);
        ASSERT_TRUE(decoded.ok()) << decoded.error().text();
        EXPECT_EQ(compare_corners(tile, *decoded), 0.0);
        EXPECT_EQ(steps.back().error, 0.0f);
    }
}

TEST(MeshLayer, EveryPrefixDecodesWithinItsStatedError) {
    for (const float finest : {0.0f, 0.05f, 1.0f, 40.0f}) {
        const MeshTile tile = random_tile(2, 1 << 19);
        const LayerSteps steps = encode_mesh(tile, finest);
        for (size_t count = 1; count <= steps.size(); ++count) {
            const Prefix prefix = prefix_of(steps, count);
            const auto decoded = decode_mesh(prefix.words, prefix.step_words, 13);
            ASSERT_TRUE(decoded.ok()) << decoded.error().text();
            EXPECT_LE(compare_corners(tile, *decoded), static_cast<double>(steps[count - 1].error - finest) + 1e-6);
            if (count > 1) {
                EXPECT_LT(steps[count - 1].error, steps[count - 2].error);
            }
        }
        EXPECT_LE(steps.back().error, finest * (1 + std::sqrt(3.0f) / 8));
    }
}

TEST(MeshLayer, CoordinatesOnTileBordersAreExactInEveryStep) {
    // The border is a multiple of 2^16 units; the tiles on its sides have other origins and sizes.
    const int32_t border = 1 << 16;
    for (const int32_t other : {-70000, 5, 64000, 66000, 1 << 20}) {
        MeshTile tile;
        tile.vertices = {vertex_at(border, 777, 3), vertex_at(other, 12345, 900), vertex_at(border, -31, 71)};
        tile.indices = {0, 1, 2};
        tile.triangle_chart = {0};
        const LayerSteps steps = encode_mesh(tile, 0);
        for (size_t count = 1; count <= steps.size(); ++count) {
            const Prefix prefix = prefix_of(steps, count);
            const auto decoded = decode_mesh(prefix.words, prefix.step_words, 1);
            ASSERT_TRUE(decoded.ok()) << decoded.error().text();
            EXPECT_EQ(decoded->vertices[0].position[0], border);
            EXPECT_EQ(decoded->vertices[2].position[0], border);
        }
    }
}

TEST(MeshLayer, EqualPositionsInTwoTilesStayEqualInEqualSteps) {
    const MeshTile low = random_tile(3, 1 << 18);
    MeshTile high = random_tile(4, 1 << 18);
    std::copy_n(low.vertices.begin(), 50, high.vertices.begin());
    for (uint32_t i = 0; i < 50; ++i) high.indices[i] = i;
    MeshTile first = low;
    for (uint32_t i = 0; i < 50; ++i) first.indices[i] = i;
    const LayerSteps a = encode_mesh(first, 0);
    const LayerSteps b = encode_mesh(high, 0);
    for (size_t count = 1; count <= 3; ++count) {
        const Prefix pa = prefix_of(a, count);
        const Prefix pb = prefix_of(b, count);
        const auto da = decode_mesh(pa.words, pa.step_words, 13);
        const auto db = decode_mesh(pb.words, pb.step_words, 13);
        ASSERT_TRUE(da.ok() && db.ok());
        for (size_t i = 0; i < 50; ++i) {
            for (int c = 0; c < 3; ++c) {
                EXPECT_EQ(da->vertices[da->indices[i]].position[c], db->vertices[db->indices[i]].position[c]);
            }
        }
    }
}

TEST(MeshLayer, EmptyTileAndSinglePointAreValid) {
    const LayerSteps empty = encode_mesh({}, 0.5f);
    ASSERT_EQ(empty.size(), 1u);
    const Prefix prefix = prefix_of(empty, 1);
    const auto decoded = decode_mesh(prefix.words, prefix.step_words, 0);
    ASSERT_TRUE(decoded.ok()) << decoded.error().text();
    EXPECT_TRUE(decoded->vertices.empty());
    EXPECT_TRUE(decoded->indices.empty());

    MeshTile point;
    point.vertices = {vertex_at(-5, 7, 9)};
    point.indices = {0, 0, 0};
    point.triangle_chart = {2};
    point.dressed_begin = 1;
    const LayerSteps steps = encode_mesh(point, 0);
    ASSERT_EQ(steps.size(), 1u);
    const Prefix whole = prefix_of(steps, 1);
    const auto back = decode_mesh(whole.words, whole.step_words, 3);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_EQ(compare_corners(point, *back), 0.0);
}

TEST(MeshLayer, SmallTilesLeaveOutStepsThatWouldHoldNothing) {
    MeshTile tile = one_triangle();
    for (MeshVertex& vertex : tile.vertices) {
        for (int32_t& c : vertex.position) c /= 64;  // at most 16 units: 5 bits
    }
    const LayerSteps steps = encode_mesh(tile, 0);
    ASSERT_EQ(steps.size(), 2u);
    EXPECT_EQ(steps[0].words[MESH_WORD_WIDTHS] >> 24, 3u);
    EXPECT_EQ(steps[1].words[1], 3u);
}

TEST(MeshLayer, WeldsEqualCornersAndKeepsTheOrderOfTriangles) {
    MeshTile tile;
    for (int t = 0; t < 4; ++t) {
        for (int c = 0; c < 3; ++c) {
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back(vertex_at(100 * (c == 1), 100 * (c == 2) + 100 * (t == 3), 0));
        }
        tile.triangle_chart.push_back(t == 2 ? 1u : 0u);
    }
    tile.vertices.push_back(vertex_at(999, 999, 999));  // used by none
    tile.dressed_begin = 3;
    const Prefix prefix = prefix_of(encode_mesh(tile, 0), 1);
    const auto view = MeshLayerView::create(prefix.words, prefix.step_words, 2);
    ASSERT_TRUE(view.ok()) << view.error().text();
    // Three of triangles 0 and 1, three more of triangle 2 (another chart), and two new ones of triangle 3 (its first
    // is the third of 0).
    EXPECT_EQ(view->vertex_count(), 3u + 3u + 2u);
    const uint32_t expected[] = {0, 1, 2, 0, 1, 2, 3, 4, 5, 2, 6, 7};
    for (uint32_t i = 0; i < 12; ++i) EXPECT_EQ(view->index(i), expected[i]) << i;
    EXPECT_EQ(view->chart_word(2), 1u);
    EXPECT_EQ(view->dressed_begin(), 3u);
}

TEST(MeshLayer, WideTextureCoordinatesAreRoundedToTheirSpan) {
    MeshTile tile = one_triangle();
    tile.vertices[0].texcoord[0] = std::numeric_limits<int32_t>::min();
    tile.vertices[1].texcoord[0] = std::numeric_limits<int32_t>::max();
    tile.vertices[2].texcoord[0] = 12345678;
    tile.vertices[2].texcoord[1] = 70000;
    const Prefix prefix = prefix_of(encode_mesh(tile, 0), 1);
    const auto decoded = decode_mesh(prefix.words, prefix.step_words, 1);
    ASSERT_TRUE(decoded.ok()) << decoded.error().text();
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(decoded->vertices[i].texcoord[0], tile.vertices[i].texcoord[0], 65536.0);
        EXPECT_NEAR(decoded->vertices[i].texcoord[1], tile.vertices[i].texcoord[1], 1.0);
    }
}

TEST(MeshLayer, SameTileGivesTheSameWords) {
    const LayerSteps a = encode_mesh(random_tile(9, 1 << 20), 0.01f);
    const LayerSteps b = encode_mesh(random_tile(9, 1 << 20), 0.01f);
    ASSERT_EQ(a.size(), b.size());
    for (size_t s = 0; s < a.size(); ++s) EXPECT_EQ(a[s].words, b[s].words);
}

TEST(MeshLayer, GoldenWordsOfOneTriangle) {
    const LayerSteps steps = encode_mesh(one_triangle(), 0);
    ASSERT_EQ(steps.size(), 3u);
    EXPECT_EQ(steps[0].words,
              (std::vector<uint32_t>{0x314d5343u, 3,           1,           1 - 1, 0,  0,  0,  0x06050002u,
                                     1,           16,          20,          21,    21, 23, 26, 0,  // header
                                     0,           0,           0x00000101u, 0,                     // chart
                                     0x24u,                                                        // indices 0, 1, 2
                                     0x7f7f7f7fu, 0x00007f7fu,                                     // normals
                                     0,           0x00008000u, 0x80000000u,  // texture coordinates
                                     0x00080000u, 0x00000880u}));            // positions >> 6: 0 0 0, 16 0 0, 0 16 8
    EXPECT_EQ(steps[1].words, (std::vector<uint32_t>{0x3150534du, 0x00000303u, 0x04924924u}));
    EXPECT_EQ(steps[2].words, (std::vector<uint32_t>{0x3150534du, 0x00000003u, 0x04924924u}));
    EXPECT_FLOAT_EQ(steps[0].error, std::sqrt(3.0f) * 63 / 1024);
    EXPECT_FLOAT_EQ(steps[1].error, std::sqrt(3.0f) * 7 / 1024);
}

TEST(MeshLayer, RefusesEveryTruncationAndWrongStepWords) {
    const LayerSteps steps = encode_mesh(one_triangle(), 0);
    const Prefix whole = prefix_of(steps, 3);
    for (size_t size = 0; size < whole.words.size(); ++size) {
        const auto cut = exact_copy(std::span(whole.words).first(size));
        EXPECT_FALSE(MeshLayerView::create(cut, whole.step_words, 1).ok()) << size;
        // The same words announced as one step: a valid step 0 needs its last position word.
        const uint32_t one_step[] = {static_cast<uint32_t>(size)};
        EXPECT_EQ(MeshLayerView::create(cut, one_step, 1).ok(), size >= whole.step_words[0]) << size;
    }
    auto longer = whole.words;
    longer.push_back(0);
    EXPECT_FALSE(MeshLayerView::create(longer, whole.step_words, 1).ok());
    const std::vector<std::vector<uint32_t>> wrong = {
        {}, {28, 3}, {28, 2, 4}, {27, 4, 3}, {28, 3, 3, 0}, {28, 3, 3, 0, 0}, {0xffffffffu, 35}, {34}};
    for (const auto& step_words : wrong) {
        const bool one_big_step = step_words == std::vector<uint32_t>{34};
        EXPECT_EQ(MeshLayerView::create(whole.words, step_words, 1).ok(), one_big_step);
    }
    EXPECT_FALSE(MeshLayerView::create(whole.words, whole.step_words, 0).ok()) << "chart 0 of no charts";
}

TEST(MeshLayer, TrianglesOfOneColourNeedNoChart) {
    MeshTile tile = one_triangle();
    tile.triangle_chart = {colour_word({10, 20, 30})};
    const Prefix layer = prefix_of(encode_mesh(tile, 0), 3);
    const auto view = MeshLayerView::create(layer.words, layer.step_words, 0);
    ASSERT_TRUE(view.ok()) << view.error().text();
    EXPECT_EQ(view->chart_word(0), 0x801e140aU);
    for (uint32_t bit = 24; bit < 31; ++bit) {
        tile.triangle_chart = {colour_word({10, 20, 30}) | 1U << bit};
        const Prefix wrong = prefix_of(encode_mesh(tile, 0), 3);
        EXPECT_FALSE(MeshLayerView::create(wrong.words, wrong.step_words, UINT32_MAX).ok()) << bit;
    }
}

TEST(MeshLayer, NoDamagedWordMakesAnAccessorReadOutside) {
    for (const MeshTile& tile : {one_triangle(), random_tile(5, 4000)}) {
        MeshTile small = tile;
        small.triangle_chart.resize(std::min<size_t>(small.triangle_chart.size(), 12));
        small.indices.resize(3 * small.triangle_chart.size());
        small.dressed_begin = 0;
        const LayerSteps steps = encode_mesh(small, 0);
        const Prefix whole = prefix_of(steps, steps.size());
        size_t accepted = 0;
        size_t refused = 0;
        for_each_mutation(whole.words, [&](std::span<const uint32_t> words) {
            const auto decoded = decode_mesh(words, whole.step_words, 13);
            ++(decoded.ok() ? accepted : refused);
        });
        EXPECT_GT(accepted, 0u);
        EXPECT_GT(refused, 0u);
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
