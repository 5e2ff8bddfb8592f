// Pictures do not depend on where layers lie in GPU memory, nor on how many draws a mesh takes.
#include <algorithm>

#include "tests/client/render/facade_scene.h"
#include "tests/client/render/scattering_store.h"

namespace citystream::client::test {
namespace {

/// Boxes of several heights in a grid, each a copy of cube_tile's triangles.
codec::mesh::MeshTile many_boxes(int count) {
    codec::mesh::MeshTile all;
    for (int i = 0; i < count; ++i) {
        const int32_t x = i % 12 * 5, y = i / 12 * 5;
        const codec::mesh::MeshTile box = cube_tile({x, y, 0}, {x + 3, y + 3, 2 + i % 7}, 2);
        const auto first = static_cast<uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), box.vertices.begin(), box.vertices.end());
        for (const uint32_t corner : box.indices) all.indices.push_back(first + corner);
        all.triangle_chart.insert(all.triangle_chart.end(), box.triangle_chart.begin(), box.triangle_chart.end());
    }
    all.dressed_begin = static_cast<uint32_t>(all.triangle_chart.size());
    return all;
}

TEST(LayerReading, AMeshWithItsLayersInPiecesDrawsTheSameBytes) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    ScatteringStore scattering(*renderer);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    const TileDraw whole = upload_tile(*renderer, many_boxes(40), charts);
    const TileDraw in_pieces = upload_tile(scattering, many_boxes(40), charts);
    const Camera camera = make_camera({-6, -14, 9}, 25, -12);
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&whole, 1));
    EXPECT_NE(pixel(image, 160, 150), pixel(image, 2, 2)) << "a box is seen";
    EXPECT_EQ(image.rgba, draw_or_fail(*renderer, camera, std::span(&in_pieces, 1)).rgba);
    // Tiles of both kinds in one frame.
    TileDraw beside = in_pieces;
    beside.origin[0] += 40;
    TileDraw whole_beside = whole;
    whole_beside.origin[0] += 40;
    const std::vector<TileDraw> mixed = {whole, beside}, straight = {whole, whole_beside};
    EXPECT_EQ(draw_or_fail(*renderer, camera, mixed).rgba, draw_or_fail(*renderer, camera, straight).rgba);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(LayerReading, FacadesWithTheirLayersInPiecesDrawTheSameBytes) {
    const Wall wall;
    const Camera camera = make_camera({2, -5, 2.5}, 6, -3);
    for (const FacadeRenderer kind : {FacadeRenderer::kPatch, FacadeRenderer::kCfdm, FacadeRenderer::kBcrm}) {
        RendererOptions options = small_options();
        options.facade_renderer = kind;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        ScatteringStore scattering(*renderer);
        const FacadeScene whole = facade_scene(*renderer, kind, window_facade(), std::span(&wall, 1));
        const FacadeScene in_pieces = facade_scene(scattering, kind, window_facade(), std::span(&wall, 1));
        const FrameImage image = draw_or_fail(*renderer, camera, std::span(&whole.tile, 1));
        EXPECT_NE(pixel(image, 160, 120), pixel(image, 2, 2)) << "the facade is seen";
        EXPECT_EQ(image.rgba, draw_or_fail(*renderer, camera, std::span(&in_pieces.tile, 1)).rgba)
            << facade_renderer_name(kind);
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

// Software drivers get large meshes in several draws.
TEST(LayerReading, AMeshOfManyDrawsShowsWhatItsPartsShow) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    codec::mesh::MeshTile mesh = many_boxes(144);
    ASSERT_GT(mesh.indices.size(), 4096u);
    const TileDraw one = upload_tile(*renderer, mesh, charts);
    std::vector<TileDraw> parts;
    for (int i = 0; i < 144; ++i) {
        const int32_t x = i % 12 * 5, y = i / 12 * 5;
        parts.push_back(upload_tile(*renderer, cube_tile({x, y, 0}, {x + 3, y + 3, 2 + i % 7}, 2), charts));
    }
    const Camera camera = make_camera({-6, -14, 9}, 25, -12);
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&one, 1));
    EXPECT_EQ(image.rgba, draw_or_fail(*renderer, camera, parts).rgba);
}

}  // namespace
}  // namespace citystream::client::test
