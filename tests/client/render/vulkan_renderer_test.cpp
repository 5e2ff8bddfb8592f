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

}  // namespace
}  // namespace citystream::client::test
