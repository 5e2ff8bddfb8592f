// The GPU's decoders against the CPU's, word for word, through the same includes that draw.
#include <cmath>

#include "codec/mesh/octahedral.h"
#include "shaders/twin_atlas.comp.h"
#include "shaders/twin_mesh.comp.h"
#include "tests/client/render/gpu_twin.h"

namespace citystream::client::test {
namespace {

codec::mesh::MeshTile random_mesh(Random& random, uint32_t triangles, uint32_t charts) {
    codec::mesh::MeshTile tile;
    for (uint32_t i = 0; i < triangles; ++i) {
        codec::mesh::MeshVertex vertex{};
        for (int32_t& p : vertex.position) p = random.between(-200000, 200000);
        double length = 0;
        double n[3];
        for (double& c : n) {
            c = random.unit() * 2 - 1;
            length += c * c;
        }
        for (int c = 0; c < 3; ++c) vertex.normal[c] = static_cast<float>(n[c] / std::sqrt(length));
        for (int32_t& t : vertex.texcoord) t = random.between(-300000, 900000);
        tile.vertices.push_back(vertex);
    }
    for (uint32_t i = 0; i < triangles; ++i) {
        for (int c = 0; c < 3; ++c) tile.indices.push_back(random.below(triangles));
        tile.triangle_chart.push_back(random.below(charts));
    }
    tile.dressed_begin = triangles;
    return tile;
}

void expect_same_corners(const codec::mesh::MeshLayerView& view, const std::vector<uint32_t>& gpu) {
    for (uint32_t corner = 0; corner < 3 * view.triangle_count(); ++corner) {
        const uint32_t* words = &gpu[size_t{corner} * TWIN_MESH_WORDS];
        const uint32_t vertex = view.index(corner);
        int32_t position[3], normal[3], texcoord[2];
        view.position(vertex, position);
        codec::mesh::unfold_octahedral16(view.packed_normal(vertex), normal);
        view.texcoord(vertex, corner / 3, texcoord);
        ASSERT_EQ(words[0], vertex) << "corner " << corner;
        for (size_t c = 0; c < 3; ++c)
            ASSERT_EQ(static_cast<int32_t>(words[1 + c]), position[c]) << "corner " << corner;
        ASSERT_EQ(words[4], view.packed_normal(vertex));
        for (size_t c = 0; c < 3; ++c) ASSERT_EQ(static_cast<int32_t>(words[5 + c]), normal[c]) << "corner " << corner;
        for (size_t c = 0; c < 2; ++c)
            ASSERT_EQ(static_cast<int32_t>(words[8 + c]), texcoord[c]) << "corner " << corner;
        ASSERT_EQ(words[10], view.chart_word(corner / 3));
    }
}

// Of all steps.
TwinConstants mesh_constants(const LayerSteps& steps, uint32_t corners) {
    TwinConstants constants{};
    constants.count = corners;
    constants.first = static_cast<uint32_t>(steps.size());
    uint32_t begin = 0;
    for (size_t s = 1; s < steps.size(); ++s) {
        begin += static_cast<uint32_t>(steps[s - 1].words.size());
        constants.mesh_step_begin[s - 1] = begin;
    }
    return constants;
}

TEST_F(GpuTwin, MeshCornersAreTheSameWordsForEveryPrefix) {
    Random random;
    for (const uint32_t triangles : {1u, 77u, 5000u}) {
        const LayerSteps steps = codec::mesh::encode_mesh(random_mesh(random, triangles, 9), 0);
        for (size_t count = 1; count <= steps.size(); ++count) {
            const std::vector<uint32_t> words = joined(steps, count);
            const std::vector<uint32_t> sizes = step_words(steps, count);
            const auto view = codec::mesh::MeshLayerView::create(words, sizes, 9);
            ASSERT_TRUE(view.ok()) << view.error().text();
            TwinConstants constants{};
            constants.count = 3 * triangles;
            constants.first = static_cast<uint32_t>(count);
            uint32_t begin = 0;
            for (size_t s = 1; s < count; ++s) {
                begin += sizes[s - 1];
                constants.mesh_step_begin[s - 1] = begin;
            }
            const LayerId layer = upload_words(words, triangles != 77);
            expect_same_corners(*view, run(k_twin_mesh_comp, layer, constants, TWIN_MESH_WORDS));
        }
    }
}

TEST_F(GpuTwin, MeshPositionsAreTheSameWordsInFieldsOfEveryWidth) {
    Random random;
    for (uint32_t bits = 0; bits < 29; ++bits) {
        codec::mesh::MeshTile tile = random_mesh(random, 50, 1);
        for (codec::mesh::MeshVertex& vertex : tile.vertices) {
            for (int32_t& p : vertex.position) p = static_cast<int32_t>(random.below(1u << bits));
        }
        const LayerSteps steps = codec::mesh::encode_mesh(tile, 0);
        const std::vector<uint32_t> words = joined(steps);
        const auto view = codec::mesh::MeshLayerView::create(words, step_words(steps), 1);
        ASSERT_TRUE(view.ok()) << view.error().text();
        const TwinConstants constants = mesh_constants(steps, 150);
        expect_same_corners(*view, run(k_twin_mesh_comp, upload_words(words, true), constants, TWIN_MESH_WORDS));
    }
}

TEST_F(GpuTwin, EveryPackedNormalUnfoldsToTheSameIntegers) {
    codec::mesh::MeshTile tile;
    for (uint32_t code = 0; code < 65536; ++code) {
        codec::mesh::MeshVertex vertex{};
        vertex.position[0] = static_cast<int32_t>(code);
        codec::mesh::unpack_octahedral16(code, vertex.normal);
        tile.vertices.push_back(vertex);
        tile.indices.push_back(code);
    }
    while (tile.indices.size() % 3 != 0) tile.indices.push_back(0);
    tile.triangle_chart.assign(tile.indices.size() / 3, 0);
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    const LayerSteps steps = codec::mesh::encode_mesh(tile, 0);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = codec::mesh::MeshLayerView::create(words, step_words(steps), 1);
    ASSERT_TRUE(view.ok());
    const TwinConstants constants = mesh_constants(steps, static_cast<uint32_t>(tile.indices.size()));
    expect_same_corners(*view, run(k_twin_mesh_comp, upload_words(words, true), constants, TWIN_MESH_WORDS));
}

TEST_F(GpuTwin, AtlasTexelsAreTheSameBytes) {
    Random random;
    std::vector<codec::atlas::ChartImage> charts = {test_chart(1, 1), test_chart(130, 67), test_chart(5, 64),
                                                    test_chart(64, 64)};
    for (uint8_t& byte : charts[1].rgb) byte = static_cast<uint8_t>(random.next());
    charts.push_back(test_chart(43, 20));
    for (size_t i = 0; i < charts[4].rgb.size() / 3; ++i)
        charts[4].alpha.push_back(static_cast<uint8_t>(random.next()));
    const LayerSteps steps = codec::atlas::encode_atlas(charts);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = codec::atlas::AtlasLayerView::create(words, step_words(steps));
    ASSERT_TRUE(view.ok()) << view.error().text();
    const LayerId layer = upload_words(words, true);
    for (uint32_t chart = 0; chart < charts.size(); ++chart) {
        for (uint32_t mip = 0; mip < view->mip_count(chart); ++mip) {
            const uint32_t width = std::max(1u, view->width(chart) >> mip);
            const uint32_t height = std::max(1u, view->height(chart) >> mip);
            TwinConstants constants{};
            constants.count = width * height;
            constants.first = chart;
            constants.second = mip;
            const std::vector<uint32_t> gpu = run(k_twin_atlas_comp, layer, constants, 1);
            for (uint32_t i = 0; i < width * height; ++i) {
                uint8_t rgb[3];
                view->texel(chart, mip, i % width, i / width, rgb);
                const uint32_t alpha = view->alpha(chart, mip, i % width, i / width);
                ASSERT_EQ(gpu[i], static_cast<uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16) | alpha << 24)
                    << "chart " << chart << " mip " << mip;
            }
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
