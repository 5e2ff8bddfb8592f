// Frames with a sun against rays to it.
#include "client/render/shadow_maps.h"

#include "client/render/shadow_cascades.h"
#include "tests/client/render/lit_scene.h"

namespace citystream::client::test {
namespace {

namespace box = tiles::radiance::test;

constexpr uint32_t kSide = 2048;

RendererOptions options_of_maps() {
    RendererOptions options = small_options();
    options.shadow_side = kSide;
    return options;
}

auto* const shared_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(options_of_maps())));

const Vec3 kToSun = {-0.48, -0.6, 0.64};

Vec3 sum_of(const Vec3& a, const Vec3& b, double s) {
    return along(a, b, s);
}

/// Ground and towers without receivers: the light of the sky is the same everywhere on a face.
LitTile square() {
    Surface surface = box::ground(-60, -60, 60, 60);
    box::add(surface, box::tower(0, 0, 8, 14));
    box::add(surface, box::tower(14, 12, 7, 9, 0.5));
    box::add(surface, box::tower(-20, 25, 10, 30, 0.2));
    return {surface, {0, 0, 0}, {}};
}

FrameLight sunny() {
    FrameLight light = uniform_light({0.25F, 0.3F, 0.4F});
    light.sun = Sun{kToSun, {2.0, 1.9, 1.7}, kSunRadius};
    return light;
}

/// Whether all points that far around one on its face are in the sun, or all in the shade.
bool is_clear(const LitPainter& painter, const LitTile& tile, const Meeting& where, const Vec3& point, double metres) {
    const auto normal = box::unit_normal(tile.surface[where.triangle]);
    const Vec3 u = std::abs(normal[2]) > 0.5 ? Vec3{1, 0, 0} : Vec3{0, 0, 1}, v = cross(normal, u);
    const bool here = painter.is_in_sun(where, point);
    for (int k = 0; k < 8; ++k) {
        const double angle = k * pi() / 4;
        const Vec3 beside = sum_of(sum_of(point, u, metres * std::cos(angle)), v, metres * std::sin(angle));
        if (painter.is_in_sun(where, beside) != here) return false;
    }
    return true;
}

TEST(ShadowMaps, PixelsAreInTheSunWhereARayToItIsFree) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const LitTile tile = square();
    const TileDraw draw = upload_lit(*renderer, tile);
    const FrameLight light = sunny();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const LitPainter painter(std::span(&tile, 1), light);
    const Camera cameras[] = {make_camera({-22, -26, 22}, 40, -28), make_camera({3, 18, 1.7}, 200, 8),
                              make_camera({30, 34, 24}, 225, -35)};
    for (size_t i = 0; i < std::size(cameras); ++i) {
        const FrameImage image = draw_or_fail(*renderer, cameras[i], std::span(&draw, 1));
        keep(image, "sun_" + std::to_string(i));
        const double texel = shadow_cascades(cameras[i], kToSun, kSide)[0].texel_metres;
        uint32_t shaded = 0;
        const PictureMatch result = match(image, cameras[i], painter, [&](const Meeting& where, const Vec3& point) {
            if (!is_clear(painter, tile, where, point, 4 * texel)) return false;
            shaded += painter.is_in_sun(where, point) ? 0 : 1;
            return true;
        });
        EXPECT_GT(result.pixels, 10000U);
        EXPECT_GT(shaded, 1000U);
        EXPECT_LT(result.off, result.pixels / 500) << "worst " << result.worst;
    }
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(ShadowMaps, ShadesStandStillWhileTheCameraMovesAndTurns) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const LitTile tile = square();
    const TileDraw draw = upload_lit(*renderer, tile);
    const FrameLight light = sunny();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    // The same points of the ground, seen straight down from two places: half a texel and more apart, whole pixels.
    const double pixel_metres = 2 * std::tan(pi() / 6) * 40 / 240;
    const Camera first = make_camera({8, -2, 40}, 0, -90),
                 second = make_camera({8 + 10 * pixel_metres, -2, 40}, 0, -90);
    const FrameImage a = draw_or_fail(*renderer, first, std::span(&draw, 1));
    const FrameImage b = draw_or_fail(*renderer, second, std::span(&draw, 1));
    keep(a, "sun_above");
    uint32_t moved = 0, compared = 0;
    const LitPainter painter(std::span(&tile, 1), light);
    for (uint32_t y = 2; y < 238; ++y) {
        for (uint32_t x = 12; x < 318; ++x) {
            const Vec3 ray = ray_through(first, x + 0.5, y + 0.5);
            const Meeting where = painter.meeting(first.position, ray);
            if (where.triangle > 1) continue;  // roofs move in the picture
            const Meeting other = painter.meeting(second.position, ray_through(second, x - 9.5, y + 0.5));
            if (other.triangle > 1) continue;
            ++compared;
            for (size_t c = 0; c < 3; ++c) {
                if (std::abs(pixel(a, x, y)[c] - pixel(b, x - 10, y)[c]) > 6) {
                    ++moved;
                    break;
                }
            }
        }
    }
    EXPECT_GT(compared, 30000U);
    EXPECT_LT(moved, compared / 1000);
}

TEST(ShadowMaps, TilesOutOfViewCastShadowsIntoItForTheFrameTheyAreGivenFor) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const TileDraw ground = upload_lit(*renderer, {box::ground(-60, -60, 60, 60), {0, 0, 0}, {}});
    // It stands behind the camera, towards the sun.
    const TileDraw tower = upload_lit(*renderer, {box::tower(-14, -18, 8, 30), {0, 0, 0}, {}});
    const FrameLight light = sunny();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({-6, -8, 8}, 38, -30);
    const FrameImage open = draw_or_fail(*renderer, camera, std::span(&ground, 1));
    renderer->set_casters(std::span(&tower, 1));
    const FrameImage shaded = draw_or_fail(*renderer, camera, std::span(&ground, 1));
    keep(shaded, "sun_caster");
    EXPECT_LT(pixel(shaded, 160, 120)[0] + 20, pixel(open, 160, 120)[0]);
    EXPECT_EQ(open.rgba, draw_or_fail(*renderer, camera, std::span(&ground, 1)).rgba);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(ShadowMaps, ASunBelowTheHorizonMakesNoMapsAndLightsNothing) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const TileDraw draw = upload_lit(*renderer, square());
    FrameLight light = sunny();
    light.sun->direction = {0.8, 0, -0.6};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({-22, -26, 22}, 40, -28);
    const FrameImage below = draw_or_fail(*renderer, camera, std::span(&draw, 1));
    const uint64_t without = renderer->frame_buffer_bytes();
    FrameLight none = light;
    none.sun.reset();
    ASSERT_TRUE(renderer->set_light(&none).ok());
    EXPECT_EQ(below.rgba, draw_or_fail(*renderer, camera, std::span(&draw, 1)).rgba) << "nor does it light walls";
    light.sun->direction = kToSun;
    ASSERT_TRUE(renderer->set_light(&light).ok());
    draw_or_fail(*renderer, camera, std::span(&draw, 1));
    const uint64_t texels = uint64_t{shadow_side(320, 240)} * shadow_side(320, 240);
    EXPECT_GE(renderer->frame_buffer_bytes(), without + 20 * texels);
    EXPECT_LT(renderer->frame_buffer_bytes(), without + 24 * texels);
}

}  // namespace
}  // namespace citystream::client::test
