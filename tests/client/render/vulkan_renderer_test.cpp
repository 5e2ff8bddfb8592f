#include "client/render/vulkan_renderer.h"

#include <cstdlib>
#include <filesystem>

#include "client/render/frame_file.h"
#include "client/render/lighting_layout.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

constexpr std::array<int, 3> kSky = {158, 189, 224};

// Frames of the tests as files, for a person to look at: CITYSTREAM_TEST_FRAMES=DIR.
void keep(const FrameImage& image, const std::string& name) {
    const char* folder = std::getenv("CITYSTREAM_TEST_FRAMES");
    if (folder == nullptr) return;
    EXPECT_TRUE(write_png(std::string(folder) + "/" + name + ".png", image).ok());
}

TEST(VulkanRenderer, EmptyFrameIsSky) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const FrameImage image = draw_or_fail(*renderer, make_camera({0, 0, 0}, 0, 0), {});
    ASSERT_EQ(image.rgba.size(), size_t{320} * 240 * 4);
    for (uint32_t y = 0; y < 240; y += 7) {
        for (uint32_t x = 0; x < 320; x += 7) ASSERT_EQ(pixel(image, x, y), kSky);
    }
    EXPECT_EQ(image.rgba[3], 255);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(VulkanRenderer, DrawsATexturedCube) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    const TileDraw tile = upload_tile(*renderer, cube_tile({0, 0, 0}, {4, 4, 4}), charts);
    const FrameImage image = draw_or_fail(*renderer, make_camera({-3, -6, 6}, 35, -22), std::span(&tile, 1));
    keep(image, "cube");
    EXPECT_EQ(pixel(image, 2, 2), kSky);
    EXPECT_NE(pixel(image, 160, 120), kSky);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

// A street of cubes in several tiles, with a coarse and a fine prefix among them.
std::vector<TileDraw> street(LayerStore& store, std::array<double, 3> shift) {
    std::vector<TileDraw> tiles;
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    for (int i = 0; i < 6; ++i) {
        const std::array<double, 3> origin = {shift[0] + i % 3 * 16.0, shift[1] + i / 3 * 16.0, shift[2] + 2.5};
        tiles.push_back(upload_tile(store, cube_tile({1, 1, 0}, {9 + i, 12, 5 + 3 * i}, 3), charts, origin));
    }
    return tiles;
}

TEST(VulkanRenderer, TheSameCityTenThousandKilometresAwayDrawsTheSameBytes) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<TileDraw> here = street(*renderer, {0, 0, 0});
    constexpr std::array<double, 3> kShift = {1e7, 1e7, 0};
    const std::vector<TileDraw> there = street(*renderer, kShift);
    for (int i = 0; i < 12; ++i) {
        const std::array<double, 3> position = {10.1 + 1.37 * i, -21.3 + 0.773 * i, 6.9 + 0.31 * i};
        const std::array<double, 3> shifted = {position[0] + kShift[0], position[1] + kShift[1], position[2]};
        const FrameImage a = draw_or_fail(*renderer, make_camera(position, 5.0 * i - 30, -8), here);
        const FrameImage b = draw_or_fail(*renderer, make_camera(shifted, 5.0 * i - 30, -8), there);
        ASSERT_EQ(a.rgba, b.rgba) << "frame " << i;
        if (i == 4) keep(a, "street");
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(VulkanRenderer, ARepeatedFrameAndAnotherRendererGiveTheSameBytes) {
    const auto first = make_renderer();
    const auto second = make_renderer();
    ASSERT_TRUE(first != nullptr && second != nullptr);
    const Camera camera = make_camera({12, -20, 9}, 8, -10);
    std::vector<TileDraw> tiles = street(*first, {0, 0, 0});
    const FrameImage a = draw_or_fail(*first, camera, tiles);
    EXPECT_EQ(a.rgba, draw_or_fail(*first, camera, tiles).rgba);
    EXPECT_EQ(a.rgba, draw_or_fail(*second, camera, street(*second, {0, 0, 0})).rgba);
    // The order of the list does not matter: nearer surfaces win.
    std::reverse(tiles.begin(), tiles.end());
    EXPECT_EQ(a.rgba, draw_or_fail(*first, camera, tiles).rgba);
}

TEST(VulkanRenderer, WordsAppendedAfterAFrameRefineTheNextOne) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(256, 256)};
    const codec::mesh::MeshTile cube = cube_tile({0, 0, 0}, {4, 4, 4});
    const auto steps = codec::mesh::encode_mesh_layer(cube, {});
    ASSERT_GT(steps.size(), 1u);
    const codec::mesh::MeshLayer first = codec::mesh::test::decoded(steps, 1), mesh = codec::mesh::test::decoded(steps);
    const LayerSteps atlas = codec::atlas::encode_atlas(charts);
    ASSERT_GE(atlas.size(), 2u);
    TileDraw tile = upload_tile(*renderer, cube, {});
    tile.mesh = upload(*renderer, first.words());
    tile.mesh_steps = 1;
    tile.atlas = upload(*renderer, atlas[0].words);
    tile.atlas_finest_mip = static_cast<uint32_t>(atlas.size()) - 1;
    const Camera camera = make_camera({-3, -6, 6}, 35, -22);
    const FrameImage coarse = draw_or_fail(*renderer, camera, std::span(&tile, 1));
    ASSERT_TRUE(renderer
                    ->refine(tile.mesh, mesh.resident.words.size(), mesh.resident.planes(1, mesh.steps),
                             mesh.resident.levels.back())
                    .ok());
    for (size_t s = 1; s < atlas.size(); ++s) ASSERT_TRUE(renderer->append(tile.atlas, atlas[s].words).ok());
    tile.mesh_steps = mesh.steps;
    tile.atlas_finest_mip = 0;
    const FrameImage fine = draw_or_fail(*renderer, camera, std::span(&tile, 1));
    EXPECT_NE(coarse.rgba, fine.rgba);
    const TileDraw whole = upload_tile(*renderer, cube, charts);
    EXPECT_EQ(fine.rgba, draw_or_fail(*renderer, camera, std::span(&whole, 1)).rgba);
}

// A street whose cubes show chart 1 of an atlas of two.
std::vector<TileDraw> street_of_second_charts(LayerStore& store, const std::vector<codec::atlas::ChartImage>& local,
                                              const std::vector<codec::atlas::SharedChartUse>& shared) {
    std::vector<TileDraw> tiles;
    const LayerSteps atlas = codec::atlas::encode_atlas(local, {}, shared);
    for (int i = 0; i < 4; ++i) {
        codec::mesh::MeshTile mesh = cube_tile({1, 1, 0}, {9 + i, 12, 5 + 3 * i}, 3);
        for (uint32_t& chart : mesh.triangle_chart) chart = 1;
        tiles.push_back(upload_tile(store, mesh, {}, {i % 2 * 16.0, i / 2 * 16.0, 2.5}));
        tiles.back().atlas = upload(store, joined(atlas));
        tiles.back().chart_count = 2;
    }
    return tiles;
}

TEST(VulkanRenderer, ASharedChartDrawsLikeAChartOfTheTilesOwn) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const codec::atlas::ChartImage other = test_chart(8, 8), chart = test_chart(256, 128);
    const LayerSteps levels = codec::atlas::encode_atlas(std::span(&chart, 1));
    ASSERT_GE(levels.size(), 3u);
    const std::vector<TileDraw> own = street_of_second_charts(*renderer, {other, chart}, {});
    std::vector<TileDraw> sharing = street_of_second_charts(*renderer, {other}, {{1, 7, 0.5f}});
    const Camera camera = make_camera({3, -2, 5}, 10, -10);
    // One layer for all tiles, and in slots apart: with a gap between its steps.
    const LayerId layer = upload(*renderer, levels[0].words);
    upload(*renderer, std::vector<uint32_t>(1));
    for (size_t level = 1; level < levels.size(); ++level) {
        ASSERT_TRUE(renderer->append(layer, levels[level].words).ok());
    }
    std::vector<FrameImage> frames;
    for (uint32_t finest = 0; finest < levels.size(); ++finest) {
        for (TileDraw& tile : sharing) tile.shared_charts = {{1, 7, layer, finest, 1, 0xff00ff}};
        frames.push_back(draw_or_fail(*renderer, camera, sharing));
    }
    keep(frames[0], "shared_chart");
    EXPECT_EQ(frames[0].rgba, draw_or_fail(*renderer, camera, own).rgba);
    EXPECT_NE(frames[0].rgba, frames.back().rgba) << "a finer mip than the tile may show is not shown";
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(VulkanRenderer, ASharedChartThatIsNotThereShowsItsColour) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    codec::atlas::ChartImage flat = test_chart(1, 1);
    flat.rgb = {132, 65, 33};  // exact in 5, 6 and 5 bits
    const std::vector<TileDraw> own = street_of_second_charts(*renderer, {test_chart(8, 8), flat}, {});
    std::vector<TileDraw> sharing = street_of_second_charts(*renderer, {test_chart(8, 8)}, {{1, 7, 0.5f}});
    for (TileDraw& tile : sharing) tile.shared_charts = {{1, 7, kNoLayer, 0, 0, 132u | 65u << 8 | 33u << 16}};
    const Camera camera = make_camera({12, -20, 9}, 8, -10);
    const FrameImage a = draw_or_fail(*renderer, camera, own), b = draw_or_fail(*renderer, camera, sharing);
    keep(b, "shared_chart_colour");
    EXPECT_EQ(a.rgba, b.rgba);
    for (TileDraw& tile : sharing) tile.shared_charts[0].chart_in_tile = 2;
    EXPECT_FALSE(renderer->draw(camera, sharing, nullptr).ok()) << "a chart that the tile does not have";
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(VulkanRenderer, SupersamplingIsTheMeanOfAFrameOfTwiceTheSize) {
    RendererOptions options = small_options();
    options.supersample = 2;
    const auto renderer = make_renderer(options);
    const auto twice = make_renderer(small_options(640, 480));
    ASSERT_TRUE(renderer != nullptr && twice != nullptr);
    const FrameImage mean = draw_or_fail(*renderer, make_camera({12, -20, 9}, 8, -10), street(*renderer, {0, 0, 0}));
    const FrameImage large =
        draw_or_fail(*twice, make_camera({12, -20, 9}, 8, -10, 640, 480), street(*twice, {0, 0, 0}));
    keep(mean, "supersampled");
    for (uint32_t y = 0; y < 240; ++y) {
        for (uint32_t x = 0; x < 320; ++x) {
            for (size_t c = 0; c < 3; ++c) {
                int sum = 2;
                for (uint32_t i = 0; i < 4; ++i) sum += pixel(large, 2 * x + i % 2, 2 * y + i / 2)[c];
                ASSERT_EQ(pixel(mean, x, y)[c], sum / 4) << x << ", " << y;
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(VulkanRenderer, BackgroundOptionReplacesTheSky) {
    RendererOptions options = small_options(64, 64);
    options.background = {1, 0, 1, 1};
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const FrameImage image = draw_or_fail(*renderer, make_camera({0, 0, 0}, 0, 0, 64, 64), {});
    EXPECT_EQ(pixel(image, 30, 30), (std::array<int, 3>{255, 0, 255}));
}

TEST(VulkanRenderer, StaysInItsBudgetAndReportsIt) {
    RendererOptions options = small_options(64, 64);
    options.gpu_budget_bytes = 1 << 20;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    EXPECT_EQ(renderer->slot_count(), options.gpu_budget_bytes / renderer->slot_bytes());
    EXPECT_EQ(renderer->gpu_bytes_allocated(), 0u);
    EXPECT_GE(renderer->frame_buffer_bytes(), uint64_t{64} * 64 * 12);
    const LayerId layer = renderer->create();
    EXPECT_TRUE(renderer->append(layer, std::vector<uint32_t>(options.gpu_budget_bytes / 4)).ok());
    EXPECT_FALSE(renderer->append(layer, std::vector<uint32_t>(1)).ok());
    EXPECT_LE(renderer->gpu_bytes_allocated(), options.gpu_budget_bytes);
    renderer->destroy(layer);
    EXPECT_EQ(renderer->slots_used(), 0u);
}

TEST(VulkanRenderer, TimesItsStages) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    FrameTimings timings;
    draw_or_fail(*renderer, make_camera({12, -20, 9}, 8, -10), street(*renderer, {0, 0, 0}), &timings);
    EXPECT_GT(timings.gpu_total_ms, 0.0);
    EXPECT_LE(timings.gpu_mesh_ms + timings.gpu_facade_ms, timings.gpu_total_ms + 1e-6);
    EXPECT_GT(timings.cpu_record_ms, 0.0);
}

TEST(VulkanRenderer, SaysWhatIsWrongWithBadCalls) {
    RendererOptions nobody = small_options();
    nobody.device = "no such device";
    const auto none = VulkanRenderer::create(nobody);
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.error().message.find("no such device"), std::string::npos);
    RendererOptions nothing = small_options(0, 10);
    EXPECT_FALSE(VulkanRenderer::create(nothing).ok());
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    EXPECT_FALSE(renderer->draw(make_camera({0, 0, 0}, 0, 0, 100, 100), {}, nullptr).ok());
    TileDraw dead;
    dead.mesh = 17;
    dead.mesh_ranges = {{1, RESIDENT_KIND_INDICES, false}};
    EXPECT_FALSE(renderer->draw(make_camera({0, 0, 0}, 0, 0), std::span(&dead, 1), nullptr).ok());
}

TEST(Devices, ListNamesTheDefaultAndItsEglMatch) {
    const std::vector<std::string> lines = list_devices();
    bool has_default = false;
    for (const std::string& line : lines) has_default |= line.find(", default") != std::string::npos;
    EXPECT_TRUE(has_default);
    for (const std::string& line : lines) std::printf("%s\n", line.c_str());
}

TEST(Devices, IndexAndPartOfTheNameChoose) {
    for (const std::string wish : {"0", "LLVM", "llvm"}) {
        RendererOptions options = small_options(64, 64);
        options.device = wish;
        const auto renderer = VulkanRenderer::create(options);
        if (!renderer) GTEST_SKIP() << "no llvmpipe here: " << renderer.error().text();
        EXPECT_FALSE((*renderer)->device_name().empty());
    }
}

}  // namespace
}  // namespace citystream::client::test
