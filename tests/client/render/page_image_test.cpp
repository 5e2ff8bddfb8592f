// Frames of tiles whose atlas is in pages: against pictures that the test makes itself on the CPU, and the same bytes
// wherever layers lie and by whatever transport coordinates come.
#include <algorithm>

#include "client/render/facade_renderer.h"
#include "tests/client/render/facade_scene.h"
#include "tests/client/render/page_scene.h"
#include "tests/client/render/scattering_store.h"

namespace citystream::client::test {
namespace {

using codec::atlas::PageLayerView;

/// Trilinear sampling as PAGES.md says, in double: the place wrapped or clamped inside the chart, then the page's
/// texels.
struct PageSampler {
    const PageLayerView& pages;
    uint32_t chart;

    // Where an axis is sampled, in texels of level 0; `coarser`: the coarser of the two levels that are read.
    static double texel_of(double place, double origin, double size, bool repeats, uint32_t coarser) {
        if (repeats) return origin + (place - std::floor(place)) * size;
        const double margin = std::min(0.5 * (1 << coarser), 0.5 * size);
        return origin + std::clamp(place * size, margin, size - margin);
    }
    Vec3 mip(uint32_t level, double x, double y) const {
        const uint32_t page = pages.chart(chart).page;
        x = x / (1 << level) - 0.5;
        y = y / (1 << level) - 0.5;
        const double wx = x - std::floor(x), wy = y - std::floor(y);
        Vec3 sum{};
        for (uint32_t i = 0; i < 4; ++i) {
            uint8_t rgb[3];
            const auto clamped = [&](double at, uint32_t side) {
                return static_cast<uint32_t>(std::clamp(at, 0.0, (side >> level) - 1.0));
            };
            pages.texel(page, level, clamped(std::floor(x) + i % 2, pages.width(page)),
                        clamped(std::floor(y) + i / 2, pages.height(page)), rgb);
            const double weight = (i % 2 != 0 ? wx : 1 - wx) * (i / 2 != 0 ? wy : 1 - wy);
            for (size_t c = 0; c < 3; ++c) sum[c] += weight * rgb[c];
        }
        return sum;
    }
    Vec3 operator()(const std::array<double, 2>& uv, const std::array<double, 2>& dx,
                    const std::array<double, 2>& dy) const {
        const codec::atlas::PageChart own = pages.chart(chart);
        const codec::atlas::ChartFrame frame = frame_of(own.packed, pages.border());
        const double w = frame.size_u, h = frame.size_v;
        const double rho = std::max(std::hypot(dx[0] * w, dx[1] * h), std::hypot(dy[0] * w, dy[1] * h));
        const double lod =
            std::clamp(std::log2(rho), static_cast<double>(pages.finest_mip()), static_cast<double>(pages.mips()));
        const auto level = static_cast<uint32_t>(lod);
        const auto coarser = static_cast<uint32_t>(std::ceil(lod));
        const double x = texel_of(uv[0], frame.origin_u, w, own.repeats_u(), coarser);
        const double y = texel_of(uv[1], frame.origin_v, h, own.repeats_v(), coarser);
        const Vec3 a = mip(level, x, y);
        if (coarser == level) return a;
        const Vec3 b = mip(coarser, x, y);
        Vec3 out{};
        for (size_t c = 0; c < 3; ++c) out[c] = a[c] + (b[c] - a[c]) * (lod - level);
        return out;
    }
};

// Ground quad of 16 x 16 m at z = 0 that shows `repeats` of its chart a side, beside other charts in its page.
void expect_quad_like_cpu(bool repeat, int32_t repeats, size_t atlas_steps, const Camera& camera,
                          const std::string& name) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    codec::mesh::MeshTile mesh;
    add_quad(mesh, {{{0, 0, 0}, {16 << 10, 0, 0}, {16 << 10, 16 << 10, 0}, {0, 16 << 10, 0}}}, {0, 0, 1}, 1, repeats,
             repeats);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(60, 60), test_chart(252, 124, repeat),
                                                          test_chart(28, 12)};
    const auto steps = codec::atlas::encode_pages(charts);
    ASSERT_TRUE(steps.ok());
    const std::vector<uint32_t> words = joined(*steps, atlas_steps);
    const auto pages = PageLayerView::create(words, step_words(*steps, atlas_steps));
    ASSERT_TRUE(pages.ok()) << pages.error().text();
    const TileDraw tile = upload_page_tile(*renderer, mesh, charts, {}, atlas_steps);
    ASSERT_EQ(tile.atlas_finest_mip, pages->finest_mip());
    const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&tile, 1));

    const PageSampler sampler{*pages, 1};
    const FrameImage cpu = ground_quad_picture(camera, repeats, sampler);
    keep(gpu, name + "_gpu");
    keep(cpu, name + "_cpu");
    EXPECT_GT(psnr(gpu, cpu), 42.0) << name;
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(PageImage, RepeatedChartLooksLikeSamplesMadeOnTheCpu) {
    expect_quad_like_cpu(true, 5, 99, make_camera({7, -2, 3}, 10, -25), "page_repeat");
}

TEST(PageImage, ClampedChartMagnifiedLooksLikeSamplesMadeOnTheCpu) {
    expect_quad_like_cpu(false, 1, 99, make_camera({8, 6, 2}, 20, -50), "page_clamp");
}

TEST(PageImage, CoarsePrefixLooksLikeItsFinestResidentLevel) {
    expect_quad_like_cpu(true, 2, 1, make_camera({7, -2, 6}, 0, -35), "page_coarse");
}

const Camera kBoxesCamera = make_camera({-6, -14, 9}, 25, -12);

TEST(PageImage, LayersInPiecesDrawTheSameBytes) {
    for (const ChartTransport transport : kChartTransports) {
        RendererOptions options = small_options();
        options.chart_transport = transport;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        ScatteringStore scattering(*renderer);
        const TileDraw whole = upload_page_tile(*renderer, mixed_boxes(30), mixed_charts(), small_pages());
        const TileDraw in_pieces = upload_page_tile(scattering, mixed_boxes(30), mixed_charts(), small_pages());
        const FrameImage image = draw_or_fail(*renderer, kBoxesCamera, std::span(&whole, 1));
        EXPECT_NE(pixel(image, 160, 150), pixel(image, 2, 2)) << "a box is seen";
        EXPECT_EQ(image.rgba, draw_or_fail(*renderer, kBoxesCamera, std::span(&in_pieces, 1)).rgba)
            << chart_transport_name(transport);
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

TEST(PageImage, TilesOfBothFormsStandInOneFrame) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(60, 60)};
    const codec::mesh::MeshTile mesh = cube_tile({0, 0, 0}, {4, 4, 4}, 1);
    TileDraw in_charts = upload_tile(*renderer, mesh, charts);
    TileDraw in_pages = upload_page_tile(*renderer, mesh, charts);
    in_pages.origin = {6, 0, 0};
    const Camera camera = make_camera({5, -9, 3}, 0, -5);
    const std::vector<TileDraw> both = {in_charts, in_pages};
    const FrameImage mixed = draw_or_fail(*renderer, camera, both);
    EXPECT_EQ(renderer->counts().page_tiles, 1u);
    in_charts.origin = {6, 0, 0};
    const std::vector<TileDraw> of_charts = {upload_tile(*renderer, mesh, charts), in_charts};
    const FrameImage plain = draw_or_fail(*renderer, camera, of_charts);
    EXPECT_EQ(renderer->counts().page_tiles, 0u);
    keep(mixed, "page_mixed");
    // The same picture in blocks that lie elsewhere.
    EXPECT_GT(psnr(mixed, plain), 32.0);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(PageImage, FacadesTakeTheirMaterialsFromPages) {
    const Wall wall;
    const Camera camera = make_camera({2, -2, 1.8}, 6, -3);
    const auto pages = codec::atlas::encode_pages(test_charts());
    ASSERT_TRUE(pages.ok());
    for (const FacadeRenderer kind : {FacadeRenderer::kPatch, FacadeRenderer::kBcrm}) {
        RendererOptions options = small_options();
        options.facade_renderer = kind;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        FacadeScene scene = facade_scene(*renderer, kind, window_facade(), std::span(&wall, 1));
        const FrameImage of_charts = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        scene.tile.atlas = upload(*renderer, joined(*pages));
        scene.tile.atlas_form = codec::atlas::AtlasForm::kPages;
        const FrameImage of_pages = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        keep(of_pages, "page_facade");
        EXPECT_NE(of_pages.rgba, of_charts.rgba) << "other blocks";
        EXPECT_GT(psnr(of_pages, of_charts), 33.0) << facade_renderer_name(kind);
        ScatteringStore scattering(*renderer);
        scene.tile.atlas = upload(scattering, joined(*pages));
        EXPECT_EQ(of_pages.rgba, draw_or_fail(*renderer, camera, std::span(&scene.tile, 1)).rgba);
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

}  // namespace
}  // namespace citystream::client::test
