// Mesh frames against pictures that the test makes itself on the CPU.
#include "tests/client/render/pictures.h"

namespace citystream::client::test {
namespace {

// Ground quad of 16 x 16 m at z = 0 that shows `repeats` of its chart a side.
void expect_quad_like_cpu(bool repeat, int32_t repeats, size_t atlas_steps, const Camera& camera,
                          const std::string& name) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    codec::mesh::MeshTile mesh;
    add_quad(mesh, {{{0, 0, 0}, {16 << 10, 0, 0}, {16 << 10, 16 << 10, 0}, {0, 16 << 10, 0}}}, {0, 0, 1}, 1, repeats,
             repeats);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(1, 1), test_chart(256, 128, repeat)};
    TileDraw tile = upload_tile(*renderer, mesh, {});
    const LayerSteps steps = codec::atlas::encode_atlas(charts);
    const size_t resident = std::min(atlas_steps, steps.size());
    const std::vector<uint32_t> words = joined(steps, resident);
    const auto atlas = codec::atlas::AtlasLayerView::create(words, step_words(steps, resident));
    ASSERT_TRUE(atlas.ok());
    tile.atlas = upload(*renderer, words);
    tile.atlas_finest_mip = atlas->finest_mip();
    const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&tile, 1));

    const Sampler sampler{*atlas, 1};
    const FrameImage cpu = ground_quad_picture(camera, repeats, sampler);
    keep(gpu, name + "_gpu");
    keep(cpu, name + "_cpu");
    EXPECT_GT(psnr(gpu, cpu), 45.0) << name;
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(MeshImage, RepeatedChartLooksLikeATextbookSampler) {
    expect_quad_like_cpu(true, 5, 99, make_camera({7, -2, 3}, 10, -25), "quad_repeat");
}

TEST(MeshImage, ClampedChartMagnifiedLooksLikeATextbookSampler) {
    expect_quad_like_cpu(false, 1, 99, make_camera({8, 6, 2}, 20, -50), "quad_clamp");
}

TEST(MeshImage, CoarseAtlasPrefixLooksLikeItsFinestResidentMip) {
    expect_quad_like_cpu(true, 2, 1, make_camera({7, -2, 6}, 0, -35), "quad_coarse");
}

}  // namespace
}  // namespace citystream::client::test
