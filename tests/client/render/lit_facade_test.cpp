// Facades in frames with a light, and the other kinds of tiles: pages, strip code, layers in pieces.
#include "tests/client/render/lit_house.h"
#include "tests/client/render/page_scene.h"
#include "tests/client/render/scattering_store.h"

namespace citystream::client::test {
namespace {

RendererOptions facade_options(bool keyed) {
    RendererOptions options = small_options();
    options.facade_samples = 1;
    options.keyed_facades = keyed;
    return options;
}

auto* const keyed_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(facade_options(true))));
auto* const plain_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(facade_options(false))));

/// Pixels of the facade against its light on the CPU; `in_sun`: whether the sun reaches a point of the wall.
template <typename InSun>
void expect_lit_facade(const House& house, const FrameLight& light, const Camera& camera, const FrameImage& image,
                       const InSun& in_sun) {
    const LitPainter painter(std::span(&house.tile, 1), light);
    const FacadePainter facade(house.scene, camera);
    uint32_t pixels = 0, off = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const SeenPoint seen = facade.look(x + 0.5, y + 0.5);
            if (!std::isfinite(seen.distance)) continue;
            const Vec3 point = along(camera.position, ray_through(camera, x + 0.5, y + 0.5), seen.distance);
            Vec3 colour = painter.sky_at(0, point, seen.normal);
            if (light.sun && dot(seen.normal, light.sun->direction) > 0) {
                const std::optional<bool> sun = in_sun(point);
                if (!sun) continue;
                for (size_t c = 0; c < 3; ++c)
                    colour[c] += *sun ? light.sun->irradiance[c] / pi() * dot(seen.normal, light.sun->direction) : 0;
            }
            for (size_t c = 0; c < 3; ++c) colour[c] *= srgb_decoded(seen.texel[c] / 255);
            const Vec3 shown = shown_light(colour);
            double worst = 0;
            for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(255 * shown[c] - pixel(image, x, y)[c]));
            ++pixels;
            off += worst > 6 ? 1 : 0;
        }
    }
    EXPECT_GT(pixels, 8000U);
    // Float and double take different sides at the edges of the relief.
    EXPECT_LT(off, pixels / 50) << pixels;
}

TEST(LitFacade, ReliefShowsTheLightOfItsOwnPlacesAndSides) {
    for (const bool keyed : {false, true}) {
        VulkanRenderer* const renderer = (keyed ? keyed_renderer : plain_renderer)->get();
        ASSERT_NE(renderer, nullptr);
        const House house = make_house(*renderer);
        const FrameLight light = day_light();
        ASSERT_TRUE(renderer->set_light(&light).ok());
        const Camera cameras[] = {make_camera({3, -5, 2}, 0, 0), make_camera({7, -2.5, 1.3}, -50, 10)};
        for (size_t i = 0; i < std::size(cameras); ++i) {
            const FrameImage image = draw_or_fail(*renderer, cameras[i], std::span(&house.scene.tile, 1));
            if (keyed) keep(image, "lit_facade_" + std::to_string(i));
            expect_lit_facade(house, light, cameras[i], image, [](const Vec3&) { return std::optional<bool>(false); });
        }
        EXPECT_EQ(renderer->validation_messages(), 0U);
    }
}

TEST(LitFacade, TheSunReachesReliefWhereItReachesTheWall) {
    VulkanRenderer* const renderer = keyed_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const House house = make_house(*renderer);
    FrameLight light = day_light();
    const Vec3 to_sun = {-0.48, -0.64, 0.6};
    light.sun = Sun{to_sun, {2.2, 2.0, 1.8}, kSunRadius};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({3, -5, 2}, 0, 0);
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&house.scene.tile, 1));
    keep(image, "lit_facade_sun");
    const LitPainter painter(std::span(&house.tile, 1), light);
    uint32_t shaded = 0, sunny = 0;
    expect_lit_facade(house, light, camera, image, [&](const Vec3& point) -> std::optional<bool> {
        // In front of the wall, where relief stands out of it; all around alike.
        const auto is_free = [&](double dx, double dz) {
            const Vec3 from = {point[0] + dx, std::min(point[1], 0.0) - 1e-3, point[2] + dz};
            return std::isinf(painter.meeting(from, to_sun).t);
        };
        const bool here = is_free(0, 0);
        for (const double d : {-0.3, 0.3}) {
            if (is_free(d, 0) != here || is_free(0, d) != here) return {};
        }
        (here ? sunny : shaded) += 1;
        return here;
    });
    EXPECT_GT(sunny, 2000U);
    EXPECT_GT(shaded, 2000U);
}

TEST(LitFacade, TilesInPiecesOfMemoryAndInOneShowTheSameBytes) {
    VulkanRenderer* const renderer = keyed_renderer->get();
    ASSERT_NE(renderer, nullptr);
    ScatteringStore scattering(*renderer);
    const House whole = make_house(*renderer), pieces = make_house(scattering);
    FrameLight light = day_light();
    light.sun = Sun{{-0.48, -0.64, 0.6}, {2.2, 2.0, 1.8}, kSunRadius};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({-9, -11, 8}, 40, -25);
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&whole.scene.tile, 1));
    keep(image, "lit_house");
    EXPECT_EQ(image.rgba, draw_or_fail(*renderer, camera, std::span(&pieces.scene.tile, 1)).rgba);
    EXPECT_EQ(renderer->counts().radiance_tiles, 1U) << "the other was lit by the frame before";
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(LitFacade, ATileLitByAnAncestorsReceiversShowsWhatItsOwnShow) {
    VulkanRenderer* const renderer = keyed_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const House house = make_house(*renderer);
    const TileDraw inheriting = inheriting_tile(*renderer, house);
    TileDraw misplaced = inheriting;
    misplaced.radiance_offset = {};
    const FrameLight light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({-9, -11, 8}, 40, -25);
    const FrameImage own = draw_or_fail(*renderer, camera, std::span(&house.scene.tile, 1));
    EXPECT_LE(greatest_difference(own, draw_or_fail(*renderer, camera, std::span(&inheriting, 1))), 1);
    EXPECT_GT(greatest_difference(own, draw_or_fail(*renderer, camera, std::span(&misplaced, 1))), 20);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

// Light that exposure makes 1 leaves colours up to 60 % as they are: what a pixel shows is its texel.
TEST(LitFacade, ChartsInPagesShowWhatChartsOfTheirOwnShow) {
    VulkanRenderer* const renderer = plain_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    const TileDraw own = upload_tile(*renderer, cube_tile({0, 0, 0}, {4, 4, 4}), charts);
    const TileDraw paged = upload_page_tile(*renderer, cube_tile({0, 0, 0}, {4, 4, 4}), charts);
    const FrameLight light = uniform_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({-3, -6, 6}, 35, -22);
    const FrameImage a = draw_or_fail(*renderer, camera, std::span(&own, 1));
    const FrameImage b = draw_or_fail(*renderer, camera, std::span(&paged, 1));
    keep(b, "lit_pages");
    EXPECT_GT(psnr(a, b), 38);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

}  // namespace
}  // namespace citystream::client::test
