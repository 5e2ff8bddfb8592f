#include "client/stream/chart_boxes.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "tests/client/stream/synthetic_city.h"
#include "tests/codec/mesh/mesh_layers.h"

namespace citystream::client {
namespace {

using tiles::tileset::Bounds;

/// Triangles here and there in 100 x 100 x 30 m, each showing one of the charts.
codec::mesh::MeshTile scattered(const std::vector<uint32_t>& charts) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int32_t> place(0, 100 << 10), near(0, 3 << 10);
    codec::mesh::MeshTile tile;
    for (uint32_t i = 0; i < 60; ++i) {
        const int32_t x = place(random), y = place(random), z = place(random) / 4;
        for (int corner = 0; corner < 3; ++corner) {
            tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
            tile.vertices.push_back({{x + near(random), y + near(random), z + near(random)}, {0, 0, 1}, {0, 0}});
        }
        tile.triangle_chart.push_back(charts[i % charts.size()]);
    }
    tile.dressed_begin = 60;
    return tile;
}

bool inside(const Bounds& box, const int32_t at[3], const std::array<double, 3>& corner) {
    for (size_t axis = 0; axis < 3; ++axis) {
        const double metres = corner[axis] + to_metres(at[axis]);
        if (metres < box.min[axis] || metres > box.max[axis]) return false;
    }
    return true;
}

TEST(ChartBoxes, OfTheFirstStepHoldTheTrianglesOfTheirChartInEveryStep) {
    const codec::mesh::MeshTile tile = scattered({5, 0, 17, 300});
    codec::mesh::MeshLayerOptions options;
    options.content.finest_error_metres = 0.5f;
    const auto steps = codec::mesh::encode_mesh_layer(tile, options);
    ASSERT_GT(steps.size(), 1u);
    const codec::mesh::MeshLayer coarse = codec::mesh::test::decoded(steps, 1);
    const std::array<double, 3> corner = {1000, -50, 7};
    const std::vector<ChartBox> boxes = chart_boxes_of(coarse.content, 1, corner, double{steps[0].error});
    ASSERT_EQ(boxes.size(), 4u);
    std::map<uint32_t, Bounds> box_of;
    for (size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_EQ(boxes[i].chart_in_tile, (std::array<uint32_t, 4>{0, 5, 17, 300})[i]);
        box_of[boxes[i].chart_in_tile] = boxes[i].bounds;
    }
    for (size_t i = 0; i < tile.indices.size(); ++i) {
        EXPECT_TRUE(inside(box_of[tile.triangle_chart[i / 3]], tile.vertices[tile.indices[i]].position, corner));
    }
    for (size_t count = 1; count <= steps.size(); ++count) {
        const codec::mesh::MeshContent content = codec::mesh::test::decoded(steps, count).content;
        codec::mesh::for_each_triangle(content, static_cast<uint32_t>(count), [&](const auto& triangle) {
            for (const auto& place : triangle.places)
                EXPECT_TRUE(inside(box_of[triangle.chart_word], place.data(), corner)) << count << " steps";
        });
    }
}

TEST(ChartBoxes, AreNoLargerThanTheTrianglesNeed) {
    const codec::mesh::MeshTile tile = scattered({2});
    const codec::mesh::MeshLayer layer = codec::mesh::test::layer_of(tile);
    const auto boxes = chart_boxes_of(layer.content, layer.steps, {0, 0, 0}, 0);
    ASSERT_EQ(boxes.size(), 1u);
    for (size_t axis = 0; axis < 3; ++axis) {
        double low = 1e9, high = -1e9;
        for (const auto& vertex : tile.vertices) {
            low = std::min(low, to_metres(vertex.position[axis]));
            high = std::max(high, to_metres(vertex.position[axis]));
        }
        EXPECT_DOUBLE_EQ(boxes[0].bounds.min[axis], low);
        EXPECT_DOUBLE_EQ(boxes[0].bounds.max[axis], high);
    }
}

TEST(ChartBoxes, AreLearntOfTilesWhoseChartsOnlyTrianglesShow) {
    test::SyntheticOptions options;
    options.shared_charts = 10;
    const auto learns = [](const test::SyntheticCity& city, tiles::tileset::TileAddress address) {
        DirectoryCache directory(city.manifest, nullptr);
        for (uint32_t level = 0; level < city.manifest.levels; level += city.manifest.subtree_levels) {
            for (const auto& [root, record] : city.tiles) {
                if (root.level != level) continue;
                EXPECT_TRUE(directory.add_subtree(city.entries.at(subtree_path(root)), root));
            }
        }
        for (NodeIndex i = 0; i < directory.nodes().size(); ++i) {
            if (directory.node(i).record->address == address) return learns_chart_boxes(directory, i);
        }
        return false;
    };
    EXPECT_FALSE(learns(test::SyntheticCity(options), {3, 0, 0})) << "its facades show charts, too";
    EXPECT_TRUE(learns(test::SyntheticCity(options), {1, 0, 0})) << "an inner tile has no facades";
    options.shared_charts = 0;
    EXPECT_FALSE(learns(test::SyntheticCity(options), {1, 0, 0}));
}

}  // namespace
}  // namespace citystream::client
