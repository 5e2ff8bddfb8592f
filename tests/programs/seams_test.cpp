// No cracks: with a magenta background, no magenta pixel shows anywhere inside the city's silhouette, whatever levels
// adjoin.

#include <gtest/gtest.h>

#include <cmath>

#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using namespace client;

uint64_t magenta_pixels(const FrameImage& image) {
    uint64_t count = 0;
    for (size_t i = 0; i < size_t{image.width} * image.height; ++i)
        count += image.rgba[4 * i] > 250 && image.rgba[4 * i + 1] < 5 && image.rgba[4 * i + 2] > 250;
    return count;
}

/// Whether all four corner rays of the view meet the plane z = ground well inside the extent: then the whole picture is
/// silhouette.
bool looks_only_at_the_city(const Camera& camera, const tiles::tileset::Bounds& extent,
                            const std::array<double, 2>& origin, double ground) {
    const double tan_y = std::tan(camera.fov_y / 2), tan_x = tan_y * camera.width / camera.height;
    for (const double sx : {-1.0, 1.0}) {
        for (const double sy : {-1.0, 1.0}) {
            double ray[3];
            for (size_t axis = 0; axis < 3; ++axis)
                ray[axis] = camera.forward[axis] + camera.right[axis] * tan_x * sx + camera.up[axis] * tan_y * sy;
            if (ray[2] > -0.02) return false;
            const double reach = (ground - camera.position[2]) / ray[2];
            for (size_t axis = 0; axis < 2; ++axis) {
                const double at = camera.position[axis] + reach * ray[axis] - origin[axis];
                if (at < extent.min[axis] + 5 || at > extent.max[axis] - 5) return false;
            }
        }
    }
    return true;
}

TEST(Seams, NoBackgroundShowsBetweenTilesOfDifferentLevelsFromAnyAngle) {
    RendererOptions renderer_options;
    renderer_options.width = 480;
    renderer_options.height = 270;
    renderer_options.background = {1, 0, 1, 1};
    auto renderer = VulkanRenderer::create(renderer_options);
    ASSERT_TRUE(renderer) << renderer.error().text();
    auto fetcher = Fetcher::open(shared_city(), FetcherOptions{});
    ASSERT_TRUE(fetcher) << fetcher.error().text();
    // A coarse tolerance keeps several levels and precisions side by side in one picture.
    StreamerOptions streamer_options;
    streamer_options.tolerance_pixels = 6;
    auto streamer = CityStreamer::open(**fetcher, **renderer, streamer_options);
    ASSERT_TRUE(streamer) << streamer.error().text();

    const auto& manifest = (*streamer)->manifest();
    const std::array<double, 2> origin = {to_metres(manifest.origin.x), to_metres(manifest.origin.y)};
    const auto& extent = manifest.extent;
    uint64_t pictures = 0;
    for (const double height : {25.0, 60.0, 140.0}) {
        for (const double pitch : {-28.0, -50.0, -85.0}) {
            for (double yaw = 0; yaw < 360; yaw += 45) {
                CameraSample sample;
                // From the middle, backing away from where it looks.
                const double angle = yaw * 3.14159265358979 / 180,
                             back = height / std::tan(-pitch * 3.14159265358979 / 180);
                sample.x = origin[0] + (extent.min[0] + extent.max[0]) / 2 - std::sin(angle) * back;
                sample.y = origin[1] + (extent.min[1] + extent.max[1]) / 2 - std::cos(angle) * back;
                sample.z = extent.min[2] + 20 + height;
                sample.yaw = yaw;
                sample.pitch = pitch;
                sample.fov = 45;
                const Camera camera = Camera::from_sample(sample, renderer_options.width, renderer_options.height);
                if (!looks_only_at_the_city(camera, extent, origin, extent.min[2])) continue;
                for (const double tolerance : {1.5, 6.0, 24.0}) {
                    (*streamer)->set_tolerance(tolerance);
                    StreamerFrame frame;
                    const auto& tiles = (*streamer)->update(camera, frame);
                    auto image = (*renderer)->draw(camera, tiles, nullptr);
                    ASSERT_TRUE(image) << image.error().text();
                    EXPECT_EQ(magenta_pixels(*image), 0u)
                        << "height " << height << " pitch " << pitch << " yaw " << yaw << " tolerance " << tolerance;
                    ++pictures;
                }
            }
        }
    }
    EXPECT_GE(pictures, 60u);
}

}  // namespace
}  // namespace citystream::tests
