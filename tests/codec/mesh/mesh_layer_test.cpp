#include "codec/mesh/mesh_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "codec/bits/range_coder.h"
#include "codec/chart_word.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "tests/codec/mesh/mesh_layers.h"

namespace citystream::codec::mesh {
namespace {

using test::decoded;
using test::decoded_bytes_of;
using test::layer_of;
using test::wire_of;

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

/// A triangle as a reader of the layer sees it, whatever its place in the order: turned to begin with the least corner.
struct SeenCorner {
    std::array<int32_t, 3> position;
    uint32_t normal;
    std::array<int32_t, 2> texcoord;
    friend auto operator<=>(const SeenCorner&, const SeenCorner&) = default;
};
struct SeenTriangle {
    uint32_t chart;
    bool dressed;
    std::array<SeenCorner, 3> corners;
    friend auto operator<=>(const SeenTriangle&, const SeenTriangle&) = default;
};

std::vector<SeenTriangle> seen(const MeshTile& tile) {
    std::vector<SeenTriangle> triangles;
    for (uint32_t t = 0; t < tile.triangle_chart.size(); ++t) {
        SeenTriangle triangle{tile.triangle_chart[t], t >= tile.dressed_begin, {}};
        for (uint32_t k = 0; k < 3; ++k) {
            const MeshVertex& v = tile.vertices[tile.indices[3 * t + k]];
            const uint64_t normal = canonical_octahedral(pack_octahedral16(v.normal), 8);
            triangle.corners[k] = {{v.position[0], v.position[1], v.position[2]}, static_cast<uint32_t>(normal), {}};
            if (!names_colour(triangle.chart)) triangle.corners[k].texcoord = {v.texcoord[0], v.texcoord[1]};
        }
        std::rotate(triangle.corners.begin(), std::min_element(triangle.corners.begin(), triangle.corners.end()),
                    triangle.corners.end());
        triangles.push_back(triangle);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

MeshLayerOptions with_error(float finest) {
    MeshLayerOptions options;
    options.content.finest_error_metres = finest;
    return options;
}

MeshLayerOptions travelling_by(MeshTransport transport) {
    MeshLayerOptions options;
    options.transport = transport;
    options.content.most_steps = transport == MeshTransport::kDraco ? 1 : 3;
    return options;
}

uint64_t bytes_of(const std::vector<MeshLayerStep>& steps) {
    uint64_t bytes = steps[0].wire.size();
    for (const MeshLayerStep& step : steps) bytes += step.wire.size();
    return bytes;
}

constexpr std::array<MeshTransport, 2> kTransports = {MeshTransport::kDefault, MeshTransport::kDraco};

TEST(MeshLayer, StepsAreChosenWhenAskedFor) {
    MeshLayerOptions all = travelling_by(MeshTransport::kDefault), chosen = all;
    chosen.choose_steps = true;
    EXPECT_EQ(3u, encode_mesh_layer(one_triangle(), all).size());
    EXPECT_LE(bytes_of(encode_mesh_layer(one_triangle(), chosen)), bytes_of(encode_mesh_layer(one_triangle(), all)));
}

TEST(MeshLayer, AllStepsGiveBackTheTileExactlyWhenTheGeometryHasNoError) {
    for (const MeshTransport transport : kTransports) {
        for (const int32_t span : {30000, 1 << 20, 1 << 28}) {
            if (transport == MeshTransport::kDraco && span > 1 << 20) continue;  // travels by our own
            const MeshTile tile = random_tile(1, span);
            const auto steps = encode_mesh_layer(tile, travelling_by(transport));
            ASSERT_EQ(steps.size(), transport == MeshTransport::kDefault ? 3u : 1u);
            const auto back = seen(to_tile(decoded(steps).content)), there = seen(tile);
            ASSERT_EQ(back.size(), there.size());
            for (size_t i = 0; i < there.size(); ++i) {
                EXPECT_EQ(back[i].chart, there[i].chart);
                EXPECT_EQ(back[i].dressed, there[i].dressed);
                for (size_t k = 0; k < 3; ++k) {
                    EXPECT_EQ(back[i].corners[k].position, there[i].corners[k].position);
                    EXPECT_EQ(back[i].corners[k].normal, there[i].corners[k].normal);
                    EXPECT_EQ(back[i].corners[k].texcoord, there[i].corners[k].texcoord);
                }
            }
            EXPECT_EQ(steps.back().error, 0.0f);
        }
    }
}

TEST(MeshLayer, GpuWordsShowTheTrianglesOfTheContent) {
    const MeshLayer layer = layer_of(random_tile(7, 1 << 20));
    const std::vector<uint32_t> words = layer.words();
    const auto view = ResidentMeshView::create(words, 13);
    ASSERT_TRUE(view.ok()) << view.error().text();
    std::map<uint32_t, int> of_content, of_words;
    for_each_triangle(layer.content, [&](const PlacedTriangle& triangle) { ++of_content[triangle.chart_word]; });
    for (uint32_t t = 0; t < view->triangle_count(); ++t) ++of_words[view->chart_word(t)];
    EXPECT_EQ(of_content, of_words);
    uint32_t triangles = 0, dressed = 0;
    for (const MeshRange& range : layer.resident.ranges) (range.dressed ? dressed : triangles) += range.triangles;
    EXPECT_EQ(triangles, 400u);
    EXPECT_EQ(dressed, 100u);
}

TEST(MeshLayer, EveryPrefixDecodesWithinItsStatedError) {
    for (const float finest : {0.0f, 0.05f, 1.0f, 40.0f}) {
        MeshTile tile = random_tile(2, 1 << 19);
        // Numbered by their texture coordinates, so that a point is found again.
        for (size_t i = 0; i < tile.vertices.size(); ++i) tile.vertices[i].texcoord[0] = static_cast<int32_t>(i);
        const auto steps = encode_mesh_layer(tile, with_error(finest));
        for (size_t count = 1; count <= steps.size(); ++count) {
            const MeshTile back = to_tile(decoded(steps, count).content, static_cast<uint32_t>(count));
            ASSERT_EQ(back.triangle_chart.size(), tile.triangle_chart.size());
            double worst = 0;
            for (const uint32_t index : back.indices) {
                const MeshVertex& got = back.vertices[index];
                const MeshVertex& want = tile.vertices[static_cast<size_t>(got.texcoord[0])];
                double square = 0;
                for (int c = 0; c < 3; ++c) square += std::pow((want.position[c] - got.position[c]) / 1024.0, 2);
                worst = std::max(worst, std::sqrt(square));
            }
            EXPECT_LE(worst, static_cast<double>(steps[count - 1].error - finest) + 1e-6);
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
        tile.triangle_chart = {colour_word({1, 2, 3})};
        const auto steps = encode_mesh_layer(tile, {});
        for (size_t count = 1; count <= steps.size(); ++count) {
            int on_border = 0;
            for_each_triangle(decoded(steps, count).content, static_cast<uint32_t>(count),
                              [&](const PlacedTriangle& triangle) {
                                  for (const auto& place : triangle.places) on_border += place[0] == border ? 1 : 0;
                              });
            EXPECT_EQ(on_border, 2) << count;
        }
    }
}

TEST(MeshLayer, AnEmptyTileAndASinglePointAreValid) {
    const MeshLayer empty = layer_of({}, with_error(0.5f));
    EXPECT_TRUE(empty.content.triangles.empty());
    EXPECT_TRUE(empty.resident.ranges.empty());
    MeshTile point;
    point.vertices = {vertex_at(-5, 7, 9)};
    point.indices = {0, 0, 0};
    point.triangle_chart = {2};
    point.dressed_begin = 1;
    EXPECT_TRUE(seen(to_tile(layer_of(point).content)) == seen(point));
}

TEST(MeshLayer, SameTileGivesTheSameBytes) {
    for (const MeshTransport transport : kTransports) {
        MeshLayerOptions options = travelling_by(transport);
        options.content.finest_error_metres = 0.01f;
        const auto a = encode_mesh_layer(random_tile(9, 1 << 20), options);
        const auto b = encode_mesh_layer(random_tile(9, 1 << 20), options);
        ASSERT_EQ(a.size(), b.size());
        for (size_t s = 0; s < a.size(); ++s) EXPECT_EQ(a[s].wire, b[s].wire);
    }
}

TEST(MeshLayer, RefusesChartsThatAreNotThere) {
    const auto steps = encode_mesh_layer(random_tile(3, 1 << 18), {});
    EXPECT_TRUE(decode_mesh_layer(wire_of(steps), decoded_bytes_of(steps), 13).ok());
    const auto fewer = decode_mesh_layer(wire_of(steps), decoded_bytes_of(steps), 12);
    ASSERT_FALSE(fewer.ok());
    EXPECT_NE(fewer.error().message.find("chart 12"), std::string::npos) << fewer.error().text();
    MeshTile coloured = one_triangle();
    coloured.triangle_chart = {colour_word({10, 20, 30})};
    const auto no_charts = encode_mesh_layer(coloured, {});
    EXPECT_TRUE(decode_mesh_layer(wire_of(no_charts), decoded_bytes_of(no_charts), 0).ok());
}

TEST(MeshLayer, RefusesOtherSizesThanTheDirectorySays) {
    const auto steps = encode_mesh_layer(random_tile(3, 1 << 18), {});
    for (size_t s = 0; s < steps.size(); ++s) {
        auto bytes = decoded_bytes_of(steps);
        bytes[s] += 4;
        EXPECT_FALSE(decode_mesh_layer(wire_of(steps), bytes, kAnyMeshChart).ok()) << s;
    }
    // A directory that says little is not a licence to make room for much.
    const std::vector<uint32_t> tiny(steps.size(), 4);
    EXPECT_FALSE(decode_mesh_layer(wire_of(steps), tiny, kAnyMeshChart).ok());
}

TEST(MeshLayer, EveryTruncationOfAStepIsRefusedOrSound) {
    for (const MeshTransport transport : kTransports) {
        const MeshLayerOptions options = travelling_by(transport);
        MeshTile tile = random_tile(5, 4000);
        tile.triangle_chart.resize(20);
        tile.indices.resize(60);
        tile.dressed_begin = 10;
        const auto steps = encode_mesh_layer(tile, options);
        for (size_t s = 0; s < steps.size(); ++s) {
            auto wire = wire_of(steps, s + 1);
            for (size_t size = 0; size < steps[s].wire.size(); ++size) {
                const std::vector<std::byte> cut(steps[s].wire.begin(),
                                                 steps[s].wire.begin() + static_cast<ptrdiff_t>(size));
                wire[s] = cut;
                const auto layer = decode_mesh_layer(wire, decoded_bytes_of(steps, s + 1), kAnyMeshChart);
                // Readers take a few missing bytes as zeros (range_coder.h): a checksum is what tells.
                if (s == 0 && size + bits::RangeDecoder::kPaddingBytes < steps[s].wire.size()) {
                    EXPECT_FALSE(layer.ok()) << size;
                }
            }
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
