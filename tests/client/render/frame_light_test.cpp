// Frames with a light: what surfaces and sky show, against the same light on the CPU.
#include "tests/client/render/lit_scene.h"

namespace citystream::client::test {
namespace {

namespace box = tiles::radiance::test;

auto* const shared_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(small_options())));

const GridPoint kOrigin = {0, 0, 0};

Surface with(Surface surface, const Surface& more) {
    box::add(surface, more);
    return surface;
}

/// Ground of 32 x 32 m with two towers, one of them turned.
const LitTile& courtyard() {
    static const LitTile kTile = [] {
        Surface surface = box::ground(0, 0, 32, 32);
        box::add(surface, box::tower(9, 9, 8, 14));
        box::add(surface, box::tower(22, 20, 7, 9, 0.5));
        return lit_tile(surface, {}, kOrigin);
    }();
    return kTile;
}

std::array<int, 3> expected_white(const Rgb& radiance) {
    std::array<int, 3> result{};
    for (size_t c = 0; c < 3; ++c) {
        const double light = static_cast<double>(radiance[c]) * srgb_decoded(kAlbedo[c] / 255);
        result[c] = static_cast<int>(std::lround(255 * srgb_encoded(tone(light))));
    }
    return result;
}

TEST(FrameLight, OpenGroundUnderAUniformSkyShowsItsColourUnderThatLight) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const LitTile ground = lit_tile(box::ground(0, 0, 32, 32), {}, kOrigin);
    TileDraw tile = upload_lit(*renderer, ground);
    const Camera camera = make_camera({16, 16, 12}, 0, -89);
    for (const float radiance : {0.3F, 1.0F, 2.5F}) {
        const FrameLight light = uniform_light({radiance, radiance, radiance});
        ASSERT_TRUE(renderer->set_light(&light).ok());
        const FrameImage image = draw_or_fail(*renderer, camera, std::span(&tile, 1));
        const auto expected = expected_white({radiance, radiance, radiance});
        for (uint32_t y = 20; y < 240; y += 40) {
            for (uint32_t x = 20; x < 320; x += 40) {
                const auto shown = pixel(image, x, y);
                for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], expected[c], 2) << x << " " << y;
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, SurfacesShowWhatTheLookupOnTheCpuSays) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const LitTile& tile = courtyard();
    ASSERT_FALSE(tile.words.empty());
    const TileDraw draw = upload_lit(*renderer, tile);
    const FrameLight light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const LitPainter painter(std::span(&tile, 1), light);
    const Camera cameras[] = {make_camera({-12, -16, 22}, 40, -28), make_camera({15, 1, 1.7}, 20, 5),
                              make_camera({40, 36, 30}, 225, -35)};
    for (size_t i = 0; i < std::size(cameras); ++i) {
        const FrameImage image = draw_or_fail(*renderer, cameras[i], std::span(&draw, 1));
        keep(image, "lit_courtyard_" + std::to_string(i));
        const PictureMatch result = match(image, cameras[i], painter, [](const Meeting&, const Vec3&) { return true; });
        EXPECT_GT(result.pixels, 10000U);
        EXPECT_LT(result.off, result.pixels / 500) << "worst " << result.worst;
    }
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, ATileWithoutReceiversIsLitByTheOpenSky) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const LitTile tile = {courtyard().surface, kOrigin, {}};
    const TileDraw draw = upload_lit(*renderer, tile);
    const FrameLight light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const LitPainter painter(std::span(&tile, 1), light);
    const Camera camera = make_camera({-12, -16, 22}, 40, -28);
    const FrameImage image = draw_or_fail(*renderer, camera, std::span(&draw, 1));
    const PictureMatch result = match(image, camera, painter, [](const Meeting&, const Vec3&) { return true; });
    EXPECT_GT(result.pixels, 10000U);
    EXPECT_EQ(result.off, 0U) << "worst " << result.worst;
    EXPECT_EQ(renderer->counts().radiance_tiles, 0U);
}

TEST(FrameLight, NeighbouringTilesMeetWithoutASeam) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    // A tower stands beside the border at x = 32 m, and darkens the ground of both.
    const Surface west = with(box::ground(0, 0, 32, 32), box::tower(26, 16, 8, 20));
    const Surface east = with(box::ground(32, 0, 64, 32), box::tower(52, 10, 8, 12));
    const LitTile tiles[] = {lit_tile(west, east, kOrigin), lit_tile(east, west, box::at(32, 0, 0))};
    const std::vector<TileDraw> draws = {upload_lit(*renderer, tiles[0]), upload_lit(*renderer, tiles[1])};
    const FrameLight light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    // Straight from above: 12 pixels a metre.
    const Camera camera = make_camera({32, 16, 100}, 0, -90, 320, 240, 11.42);
    const FrameImage image = draw_or_fail(*renderer, camera, draws);
    keep(image, "lit_border");
    int across = 0, inside = 0;
    for (uint32_t y = 0; y < 240; ++y) {
        for (uint32_t x = 150; x < 170; ++x) {
            for (size_t c = 0; c < 3; ++c) {
                const int difference = std::abs(pixel(image, x, y)[c] - pixel(image, x + 1, y)[c]);
                int& most = x == 159 ? across : inside;
                most = std::max(most, difference);
            }
        }
    }
    EXPECT_LE(across, inside);
    EXPECT_GT(inside, 0) << "the light changes there";
}

TEST(FrameLight, LightPassesRunWhenTheLightOrATileIsNewAndNotForAnotherView) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const TileDraw tile = upload_lit(*renderer, courtyard());
    FrameLight light = day_light();
    const auto tiles_lit = [&](double yaw) {
        draw_or_fail(*renderer, make_camera({-12, -16, 22}, yaw, -28), std::span(&tile, 1));
        return renderer->counts().radiance_tiles;
    };
    ASSERT_TRUE(renderer->set_light(&light).ok());
    EXPECT_EQ(tiles_lit(40), 1U);
    EXPECT_GT(renderer->counts().radiance_receivers, 50U);
    EXPECT_EQ(tiles_lit(50), 0U);
    light.exposure = 2;
    ASSERT_TRUE(renderer->set_light(&light).ok());
    EXPECT_EQ(tiles_lit(40), 0U) << "exposure is not the light";
    light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    EXPECT_EQ(tiles_lit(40), 1U);
    EXPECT_EQ(tiles_lit(40), 0U);
    const TileDraw more[] = {tile, upload_lit(*renderer, courtyard())};
    draw_or_fail(*renderer, make_camera({-12, -16, 22}, 40, -28), more);
    EXPECT_EQ(renderer->counts().radiance_tiles, 1U);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, FramesWithoutALightAreTheSameBytesAndMakeNothing) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    TileDraw tile = upload_lit(*renderer, {courtyard().surface, kOrigin, {}});
    const Camera camera = make_camera({-12, -16, 22}, 40, -28);
    const FrameImage before = draw_or_fail(*renderer, camera, std::span(&tile, 1));
    const uint64_t bytes = renderer->frame_buffer_bytes();
    tile.radiance = upload(*renderer, courtyard().words);
    EXPECT_EQ(before.rgba, draw_or_fail(*renderer, camera, std::span(&tile, 1)).rgba);
    EXPECT_FALSE(renderer->has_radiance_pipeline());
    EXPECT_EQ(renderer->frame_buffer_bytes(), bytes);

    const FrameLight light = day_light();
    ASSERT_TRUE(renderer->set_light(&light).ok());
    EXPECT_FALSE(renderer->has_radiance_pipeline()) << "nothing was drawn yet";
    EXPECT_NE(before.rgba, draw_or_fail(*renderer, camera, std::span(&tile, 1)).rgba);
    EXPECT_TRUE(renderer->has_radiance_pipeline());
    EXPECT_GT(renderer->frame_buffer_bytes(), bytes);

    ASSERT_TRUE(renderer->set_light(nullptr).ok());
    EXPECT_EQ(before.rgba, draw_or_fail(*renderer, camera, std::span(&tile, 1)).rgba);
    EXPECT_FALSE(renderer->has_radiance_pipeline());
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, TheBackgroundIsTheEnvironmentAlsoAtItsSeamAndPoles) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    FrameLight light = light_of([](const Direction& d) -> Rgb {
        return {static_cast<float>(0.5 + 0.4 * d[0]), static_cast<float>(0.4 + 0.3 * d[1] * d[0]),
                static_cast<float>(0.5 + 0.4 * d[2])};
    });
    light.exposure = 0.8F;
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera cameras[] = {make_camera({5, 6, 7}, 0, 0), make_camera({5, 6, 7}, 180, 10),
                              make_camera({5, 6, 7}, 30, 89), make_camera({5, 6, 7}, 30, -90)};
    for (const Camera& camera : cameras) {
        const FrameImage image = draw_or_fail(*renderer, camera, {});
        for (uint32_t y = 0; y < 240; y += 3) {
            for (uint32_t x = 0; x < 320; x += 3) {
                const Rgb radiance = light.background.radiance(ray_through(camera, x + 0.5, y + 0.5));
                for (size_t c = 0; c < 3; ++c) {
                    const double shown = 255 * srgb_encoded(tone(0.8 * static_cast<double>(radiance[c])));
                    ASSERT_NEAR(pixel(image, x, y)[c], shown, 2) << x << " " << y;
                }
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, TheSunsDiscIsWhiteAndAsLargeAsItsRadius) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    FrameLight light = uniform_light({0.2F, 0.3F, 0.5F});
    const double height = 20 * pi() / 180, radius = 0.05;
    light.sun = Sun{{0, std::cos(height), std::sin(height)}, {3, 2.8, 2.5}, radius};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const Camera camera = make_camera({0, 0, 0}, 0, 20);
    const FrameImage image = draw_or_fail(*renderer, camera, {});
    keep(image, "sun_disc");
    uint32_t white = 0;
    for (uint32_t y = 0; y < 240; ++y) {
        for (uint32_t x = 0; x < 320; ++x) white += pixel(image, x, y)[2] > 245 ? 1 : 0;
    }
    // Pixels at the rim of which a little is covered are white, too.
    const double pixels = radius / std::tan(pi() / 6) * 120 + 0.5, area = pi() * pixels * pixels;
    EXPECT_NEAR(white, area, 0.05 * area);
    EXPECT_EQ(pixel(image, 160, 120), (std::array<int, 3>{255, 255, 255}));
}

TEST(FrameLight, OfADiscAtTheHorizonTheHalfAboveItIsSeen) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    FrameLight light = uniform_light({0.2F, 0.3F, 0.5F});
    light.sun = Sun{{0, 1, 0}, {3, 2.8, 2.5}, 0.05};
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const FrameImage image = draw_or_fail(*renderer, make_camera({0, 0, 0}, 0, 0), {});
    for (int x = 150; x <= 170; ++x) {
        const int inside = static_cast<int>(std::sqrt(10.0 * 10 - (x - 160) * (x - 160)) / 2);
        for (int y = 1; y < inside; ++y) EXPECT_GT(pixel(image, x, 119 - y)[2], 245) << x << " " << y;
        for (int y = 1; y < 20; ++y) EXPECT_LT(pixel(image, x, 119 + y)[2], 245) << x << " " << y;
    }
}

TEST(FrameLight, FramesOfSeveralSamplesAPixelShowTheSame) {
    RendererOptions options = small_options();
    options.supersample = 2;
    const auto renderer = make_renderer(options);
    VulkanRenderer* const single = shared_renderer->get();
    ASSERT_TRUE(renderer != nullptr && single != nullptr);
    FrameLight light = day_light();
    light.sun = Sun{{0.48, 0.6, 0.64}, {2, 1.9, 1.7}, 0.03};
    const Camera camera = make_camera({-2, -4, 14}, 35, 12);
    const auto frame = [&](VulkanRenderer& of) {
        const TileDraw tile = upload_lit(of, courtyard());
        EXPECT_TRUE(of.set_light(&light).ok());
        return draw_or_fail(of, camera, std::span(&tile, 1));
    };
    const FrameImage fine = frame(*renderer);
    keep(fine, "lit_supersampled");
    EXPECT_GT(psnr(fine, frame(*single)), 30) << "edges differ";
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(FrameLight, ThatCannotBeIsRefused) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const FrameLight good = uniform_light();
    const auto refuses = [&](auto change) {
        FrameLight light = good;
        light.number = next_light_number();
        change(light);
        return !renderer->set_light(&light).ok();
    };
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(refuses([](FrameLight&) {}));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.background.texels[5][1] = kNan; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.background.texels[7][0] = -1; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.background.texels.pop_back(); }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.background = {}; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.sky.values.pop_back(); }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.sky.unit[1] = -1; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.ambient.coefficients[3][2] = kInfinity; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.exposure = kInfinity; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.sun = Sun{{0, 0, 2}, {1, 1, 1}, 0.01}; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.sun = Sun{{0, 0, 1}, {1, -1, 1}, 0.01}; }));
    EXPECT_TRUE(refuses([](FrameLight& light) { light.sun = Sun{{0, 0, 1}, {1, 1, 1}, 0}; }));
}

TEST(FrameLight, NoLightAtAllIsBlack) {
    VulkanRenderer* const renderer = shared_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const TileDraw tile = upload_lit(*renderer, courtyard());
    const FrameLight light = uniform_light({0, 0, 0});
    ASSERT_TRUE(renderer->set_light(&light).ok());
    const FrameImage image = draw_or_fail(*renderer, make_camera({-12, -16, 22}, 40, -28), std::span(&tile, 1));
    for (uint32_t y = 0; y < 240; y += 5) {
        for (uint32_t x = 0; x < 320; x += 5) ASSERT_EQ(pixel(image, x, y), (std::array<int, 3>{0, 0, 0}));
    }
}

}  // namespace
}  // namespace citystream::client::test
