// Frames with facades against pictures that the test casts on the CPU.
#include <map>

#include "tests/client/render/facade_scene.h"

namespace citystream::client::test {
namespace {

RendererOptions options_for(FacadeRenderer renderer) {
    RendererOptions options = small_options();
    options.facade_samples = kTestedSamples;
    options.gpu_budget_bytes = 64 << 20;
    options.facade_renderer = renderer;
    return options;
}

/// One renderer of each kind for all tests: compiling its shaders takes longer than drawing with them.
class SharedRenderers : public testing::Environment {
  public:
    void TearDown() override { renderers_.clear(); }
    VulkanRenderer* of(FacadeRenderer kind) {
        std::unique_ptr<VulkanRenderer>& renderer = renderers_[kind];
        if (renderer == nullptr) renderer = make_renderer(options_for(kind));
        return renderer.get();
    }

  private:
    std::map<FacadeRenderer, std::unique_ptr<VulkanRenderer>> renderers_;
};
auto* const shared_renderers = static_cast<SharedRenderers*>(testing::AddGlobalTestEnvironment(new SharedRenderers));

struct View {
    std::string name;
    Camera camera;
};

void expect_like_rays(FacadeRenderer kind, const codec::facade::RunGrid& grid, const Wall& wall,
                      const std::string& name, std::span<const View> views) {
    VulkanRenderer* renderer = shared_renderers->of(kind);
    ASSERT_NE(renderer, nullptr);
    const FacadeScene scene = facade_scene(*renderer, kind, grid, std::span(&wall, 1));
    for (const auto& [view, camera] : views) {
        const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        expect_almost_equal(gpu, cast_facade_picture(scene, camera, kTestedSamples),
                            name + "_" + view + "_" + std::string(facade_renderer_name(kind)));
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

class FacadeImage : public testing::TestWithParam<FacadeRenderer> {};

TEST_P(FacadeImage, LooksLikeRaysCastOnTheCpu) {
    const View views[] = {{"front", make_camera({3, -5, 2}, 0, 0)},
                          {"left", make_camera({-2, -3, 3}, 55, -10)},
                          {"right_low", make_camera({7, -2, 0.3}, -50, 20)},
                          {"grazing", make_camera({-4, -0.36, 2}, 89.5, 0)},
                          {"from_above", make_camera({3, -1, 7}, 5, -70)},
                          {"behind", make_camera({2, 4, 2}, 170, 5)},
                          {"far", make_camera({-30, -90, 30}, 20, -17, 320, 240, 8)}};
    expect_like_rays(GetParam(), window_facade(), {}, "facade", views);
}

TEST_P(FacadeImage, OpenCellsShowWhatIsBehind) {
    const View views[] = {{"front", make_camera({3, -5, 2}, 0, 0)},
                          {"left", make_camera({1, -3, 1}, 30, 5)},
                          {"behind", make_camera({4, 3, 1.5}, 190, 0)},
                          {"in_the_gateway", make_camera({3.2, 0.2, 1.2}, 20, 0)}};
    expect_like_rays(GetParam(), window_facade(true), {}, "open", views);
}

// In a recess, between the volume's front and a balcony, in the wall's plane, and where the near plane (0.1 m) cuts the
// quads.
TEST_P(FacadeImage, IsWholeWithTheCameraInTheVolume) {
    const View views[] = {{"in_the_window", make_camera({1.0, 0.05, 2}, 30, 5)},
                          {"in_the_door", make_camera({4.4, 0.2, 1.2}, -70, -10)},
                          {"before_the_wall", make_camera({3, -0.2, 2}, 60, 10)},
                          {"along_the_wall", make_camera({0.2, -0.1, 2.2}, 90, 0)},
                          {"at_the_top_quad", make_camera({3, -0.40, 2}, 20, 15)},
                          {"at_a_side_quad", make_camera({-0.05, -0.15, 2}, 80, 3)},
                          {"outwards", make_camera({4.4, 0.2, 1.2}, 180, 0)}};
    expect_like_rays(GetParam(), window_facade(), {}, "inside", views);
}

TEST_P(FacadeImage, TurnedStretchedAndMirroredFramesAreTheSameRelief) {
    const View views[] = {{"front", make_camera({12, 8, 2}, -90, 0)}, {"side", make_camera({9, 4.5, 5}, -50, -25)}};
    expect_like_rays(GetParam(), mirrored(window_facade()), {{7, 3, -1}, {0, 9}, 5}, "turned", views);
    const View oblique[] = {{"front", make_camera({-5, -5, 2}, 45, 0)}, {"side", make_camera({-1, -5, 3}, 20, -5)}};
    expect_like_rays(GetParam(), window_facade(), {{0, 3, 0}, {4, -4.5}, 3}, "oblique", oblique);
}

// A mirrored map in front of a mirrored camera is the mirrored frame: no direction of steps is special.
TEST_P(FacadeImage, MirroredMapsGiveMirroredFrames) {
    VulkanRenderer* renderer = shared_renderers->of(GetParam());
    ASSERT_NE(renderer, nullptr);
    const Wall wall;
    const FacadeScene one = facade_scene(*renderer, GetParam(), window_facade(), std::span(&wall, 1));
    const FacadeScene other = facade_scene(*renderer, GetParam(), mirrored(window_facade()), std::span(&wall, 1));
    TileDraw tiles[2] = {one.tile, other.tile};
    for (TileDraw& tile : tiles) tile.atlas = kNoLayer;
    FrameImage a = draw_or_fail(*renderer, make_camera({1.25, -4, 2.5}, 17, -8), std::span(tiles, 1));
    const FrameImage b = draw_or_fail(*renderer, make_camera({6 - 1.25, -4, 2.5}, -17, -8), std::span(tiles + 1, 1));
    // The light is not mirrored: only whether something is hit is compared, and the colour of fronts.
    size_t different = 0;
    for (uint32_t y = 0; y < a.height; ++y) {
        for (uint32_t x = 0; x < a.width; ++x) {
            const auto p = pixel(a, x, y), q = pixel(b, a.width - 1 - x, y);
            const auto sky = pixel(a, 0, 0);
            const bool fronts = p == pixel(a, a.width / 2, a.height / 2);
            if ((p == sky) != (q == sky) || (fronts && p != q)) ++different;
        }
    }
    EXPECT_LE(different, a.rgba.size() / 4 / 200);
}

// A slab of mesh stands in the relief: in front of the recessed window, behind the balcony's edge.
TEST_P(FacadeImage, ReliefAndMeshHideEachOther) {
    VulkanRenderer* renderer = shared_renderers->of(GetParam());
    ASSERT_NE(renderer, nullptr);
    const Wall wall;
    const FacadeScene scene = facade_scene(*renderer, GetParam(), window_facade(), std::span(&wall, 1));
    codec::mesh::MeshTile slab;
    constexpr double kNear = -0.3, kFar = 0.3;  // from before the wall at the left to behind it at the right
    const auto grid = [](double m) { return static_cast<int32_t>(std::lround(m * 1024)); };
    add_quad(slab,
             {{{grid(0), grid(kNear), grid(0.5)},
               {grid(6), grid(kFar), grid(0.5)},
               {grid(6), grid(kFar), grid(3.9)},
               {grid(0), grid(kNear), grid(3.9)}}},
             {0, -1, 0}, 0);
    const TileDraw mesh = upload_tile(*renderer, slab, {});
    const TileDraw tiles[2] = {scene.tile, mesh};
    const Camera camera = make_camera({2, -5, 2.5}, 6, -3);
    const FrameImage gpu = draw_or_fail(*renderer, camera, tiles);
    const FacadePainter painter(scene, camera);
    const FrameImage cpu = picture(camera, [&](double x, double y) {
        const SeenPoint relief = painter.look_at_pixel(x, y, kTestedSamples);
        // The slab's plane: y = kNear + (kFar - kNear) * x / 6.
        const Vec3 d = ray_through(camera, x, y);
        const double slope = (kFar - kNear) / 6;
        const double t = (kNear + slope * camera.position[0] - camera.position[1]) / (d[1] - slope * d[0]);
        const double at_x = camera.position[0] + t * d[0], at_z = camera.position[2] + t * d[2];
        const bool on_slab = t > 0 && at_x >= 0 && at_x <= 6 && at_z >= 0.5 && at_z <= 3.9;
        if (on_slab && t < relief.distance) return lit({0.7 * 255, 0.7 * 255, 0.7 * 255}, {0, -1, 0});
        return std::isfinite(relief.distance) ? relief.colour : kSkyColour;
    });
    expect_almost_equal(gpu, cpu, "slab_" + std::string(facade_renderer_name(GetParam())));
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Renderers, FacadeImage, testing::ValuesIn(kExactRenderers), [](const auto& row) {
    std::string name(facade_renderer_name(row.param));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

/// A street of walls before and behind each other, some of them open; meshes between them.
std::vector<TileDraw> crowd(LayerStore& store, FacadeRenderer kind) {
    const Wall front[] = {
        {{0, 0, 0}, {6, 0}, 4}, {{7, -1, 0}, {5, 3}, 5}, {{2, 1, 0}, {0, 6}, 4}, {{0.5, 2, 0}, {6, 0.5}, 6}};
    const Wall back[] = {{{-3, 4, 0}, {9, 1}, 7}, {{1, 6, 0}, {12, 0}, 9}, {{14, 5, 0}, {-12, 0}, 3}};
    std::vector<TileDraw> tiles = {facade_scene(store, kind, window_facade(true), front).tile,
                                   facade_scene(store, kind, window_facade(), back).tile};
    tiles.push_back(upload_tile(store, cube_tile({3, 3, 0}, {5, 5, 2}), {}));
    return tiles;
}

// The two ways to keep the nearest hit, and a prepass that hides nothing that shows.
TEST(FacadePass, KeysAndDepthWritesGiveTheSameFrames) {
    RendererOptions options = options_for(FacadeRenderer::kPatch);
    options.keyed_facades = false;
    const auto plain = make_renderer(options);
    options.keyed_facades = true;
    const auto keyed = make_renderer(options);
    ASSERT_TRUE(plain != nullptr && keyed != nullptr);
    const std::vector<TileDraw> a = crowd(*plain, FacadeRenderer::kPatch), b = crowd(*keyed, FacadeRenderer::kPatch);
    for (int i = 0; i < 12; ++i) {
        const double angle = i * 0.5236;
        const Camera camera =
            make_camera({4 + 9 * std::sin(angle), 2 - 9 * std::cos(angle), 1.5 + 0.4 * i}, -i * 30.0, -5 - i);
        const FrameImage first = draw_or_fail(*plain, camera, a), second = draw_or_fail(*keyed, camera, b);
        keep(first, "crowd_" + std::to_string(i));
        size_t different = 0;
        for (size_t p = 0; p < first.rgba.size(); ++p)
            different += std::abs(first.rgba[p] - second.rgba[p]) > 1 ? 1 : 0;
        EXPECT_LE(different, 12u) << "view " << i;
    }
    EXPECT_EQ(plain->validation_messages() + keyed->validation_messages(), 0u);
}

// What stands behind a facade shows through its openings and beside it, and nowhere else.
TEST(FacadePass, OpaqueFacadesHideAndOpenOnesDoNot) {
    VulkanRenderer* renderer = shared_renderers->of(FacadeRenderer::kPatch);
    ASSERT_NE(renderer, nullptr);
    const Wall walls[] = {{{0, 0, 0}, {6, 0}, 4}}, behind[] = {{{-2, 3, -1}, {10, 0}, 8}};
    for (const bool open : {false, true}) {
        const FacadeScene near = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(open), walls);
        const FacadeScene far = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(), behind);
        const TileDraw tiles[2] = {near.tile, far.tile};
        const Camera camera = make_camera({2.5, -4, 1.6}, 12, 4);
        const FacadePainter first(near, camera), second(far, camera);
        const FrameImage cpu = picture(camera, [&](double x, double y) {
            const SeenPoint a = first.look_at_pixel(x, y, kTestedSamples),
                            b = second.look_at_pixel(x, y, kTestedSamples);
            const SeenPoint& seen = a.distance <= b.distance ? a : b;
            return std::isfinite(seen.distance) ? seen.colour : kSkyColour;
        });
        expect_almost_equal(draw_or_fail(*renderer, camera, tiles), cpu, open ? "behind_open" : "behind_opaque");
    }
}

TEST(FacadePass, IsMadeWhenTheFirstTileWithReliefIsDrawn) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const Camera camera = make_camera({3, -5, 2}, 0, 0);
    const TileDraw mesh = upload_tile(*renderer, cube_tile({0, 0, 0}, {4, 4, 4}), {});
    draw_or_fail(*renderer, camera, std::span(&mesh, 1));
    EXPECT_FALSE(renderer->has_facade_pipeline());
    const Wall wall;
    const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(), std::span(&wall, 1));
    draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
    EXPECT_TRUE(renderer->has_facade_pipeline());
}

// A map in a form that the renderer does not draw shows nothing, and reads nothing.
TEST(FacadePass, DrawsNothingOfMapsInAForeignForm) {
    const auto renderer = make_renderer(options_for(FacadeRenderer::kMaxMip));
    ASSERT_NE(renderer, nullptr);
    const Wall wall;
    const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kFdm, window_facade(), std::span(&wall, 1));
    const FrameImage image = draw_or_fail(*renderer, make_camera({3, -5, 2}, 0, 0), std::span(&scene.tile, 1));
    EXPECT_EQ(pixel(image, 160, 120), pixel(image, 0, 0));
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

TEST(FacadePass, RefusesPlacementsWithoutAMapAndOtherNumbersOfRays) {
    const auto renderer = make_renderer();
    ASSERT_NE(renderer, nullptr);
    const Wall wall;
    FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(), std::span(&wall, 1));
    scene.tile.map_of_placement = {3};
    const auto drawn = renderer->draw(make_camera({3, -5, 2}, 0, 0), std::span(&scene.tile, 1), nullptr);
    ASSERT_FALSE(drawn.ok());
    EXPECT_NE(drawn.error().text().find("map 3"), std::string::npos);
    for (const uint32_t samples : {0u, 2u, 4u, 14u}) {
        RendererOptions options = small_options();
        options.facade_samples = samples;
        EXPECT_FALSE(VulkanRenderer::create(options).ok()) << samples;
    }
    EXPECT_EQ(facade_sample_names(), (std::vector<std::string>{"1", "5", "13"}));
    EXPECT_EQ(facade_samples_named("13"), 13u);
    EXPECT_EQ(facade_samples_named("4"), std::nullopt);
}

// Relief mapping may miss what is thin and takes sides for fronts, but shows the same facade.
TEST(FacadePass, ReliefMappingComesNear) {
    for (const FacadeRenderer kind : {FacadeRenderer::kRm, FacadeRenderer::kCrm, FacadeRenderer::kBcrm}) {
        VulkanRenderer* renderer = shared_renderers->of(kind);
        ASSERT_NE(renderer, nullptr);
        const Wall wall;
        const FacadeScene scene = facade_scene(*renderer, kind, window_facade(), std::span(&wall, 1));
        const Camera camera = make_camera({3, -5, 2}, 0, 0);
        const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        keep(gpu, "relief_" + std::string(facade_renderer_name(kind)));
        EXPECT_GT(psnr(gpu, cast_facade_picture(scene, camera, kTestedSamples)), 22.0) << facade_renderer_name(kind);
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

// Beside a corner that is seen along one of its walls, rays into the other's recess pass close by the back of the
// first.
TEST(FacadePass, NoBackHidesTheRecessBesideIt) {
    const uint32_t frame = codec::facade::make_label(0, 1), glass = codec::facade::make_label(-150, 3);
    const codec::facade::RunGrid framed = {
        {0, 9, 591, 600}, {0, 9, 391, 400}, {frame, frame, frame, frame, glass, frame, frame, frame, frame}};
    const Wall walls[2] = {{{0, 0, 0}, {6, 0}, 4}, {{6, 0, 0}, {0, 6}, 4}};
    for (const bool keyed : {false, true}) {
        RendererOptions options = options_for(FacadeRenderer::kPatch);
        options.background = {1, 0, 1, 1};
        options.keyed_facades = keyed;
        const auto renderer = make_renderer(options);
        ASSERT_NE(renderer, nullptr);
        const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, framed, walls);
        for (const double beside : {0.2, 0.8, 3.0}) {
            const double yaw = std::atan2(5.85 - (6 + beside), 10) * 180 / 3.14159265358979323846;
            const Camera camera = make_camera({6 + beside, -10, 2}, yaw, 0, 320, 240, 1);
            const FrameImage image = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
            for (uint32_t y = 0; y < 240; ++y) {
                for (uint32_t x = 0; x < 320; ++x)
                    ASSERT_NE(pixel(image, x, y), (std::array<int, 3>{255, 0, 255})) << beside << ": " << x << " " << y;
            }
        }
        EXPECT_EQ(renderer->validation_messages(), 0u);
    }
}

// Two walls around an edge, seen from where both show: near and far, at blunt and sharp angles. Where they meet at less
// than a right angle, the end of each stands out of the other's front.
TEST(FacadePass, EdgesOfFarBlocksHaveNoGaps) {
    constexpr double kPi = 3.14159265358979323846;
    constexpr uint32_t kWidth = 320, kHeight = 240;
    const uint32_t frame = codec::facade::make_label(0, 1), glass = codec::facade::make_label(-250, 3);
    const codec::facade::RunGrid framed = {
        {0, 60, 540, 600}, {0, 60, 340, 400}, {frame, frame, frame, frame, glass, frame, frame, frame, frame}};
    RendererOptions options = options_for(FacadeRenderer::kPatch);
    options.background = {1, 0, 1, 1};
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    for (const double interior : {50.0, 84.0, 90.0, 91.0, 140.0, 175.0}) {
        // The edge stands at the origin; the walls run back from it to both sides.
        const double half = interior / 2 * kPi / 180;
        const std::array<double, 2> left = {-6 * std::sin(half), 6 * std::cos(half)};
        const std::array<double, 2> right = {-left[0], left[1]};
        const Wall walls[2] = {{{left[0], left[1], 0}, {-left[0], -left[1]}, 4}, {{0, 0, 0}, right, 4}};
        const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, framed, walls);
        for (int i = 0; i < 40; ++i) {
            const double distance = 8 * std::pow(60.0, i / 39.0);
            const double turn = std::min(half, kPi / 2 - half / 2) * 0.8 * std::sin(i * 1.7);
            const Vec3 position = {distance * std::sin(turn), -distance * std::cos(turn), 1.7 + i % 3};
            // Pixels of a street view: a thousandth of the distance.
            const Camera camera = make_camera(position, -turn * 180 / kPi, 0, kWidth, kHeight, 0.24 * 180 / kPi);
            const FrameImage image = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
            // What is seen of the walls along the horizon of the camera, which is below their tops.
            for (uint32_t y = kHeight / 2; y < kHeight / 2 + 3; ++y) {
                uint32_t first = kWidth, last = 0;
                for (uint32_t x = 0; x < kWidth; ++x) {
                    if (pixel(image, x, y) == std::array<int, 3>{255, 0, 255}) continue;
                    first = std::min(first, x);
                    last = x;
                }
                ASSERT_LT(first, last) << interior << " degrees, view " << i;
                for (uint32_t x = first; x <= last; ++x)
                    ASSERT_NE(pixel(image, x, y), (std::array<int, 3>{255, 0, 255}))
                        << interior << " degrees, view " << i << ": " << x << ", " << y;
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

// Four equal walls around a block, a roof and the ground: from outside no pixel between them shows the background.
TEST(FacadePass, CornersOfABuildingHaveNoGaps) {
    RendererOptions options = options_for(FacadeRenderer::kPatch);
    options.background = {1, 0, 1, 1};
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const Wall walls[4] = {
        {{0, 0, 0}, {6, 0}, 4}, {{6, 0, 0}, {0, 6}, 4}, {{6, 6, 0}, {-6, 0}, 4}, {{0, 6, 0}, {0, -6}, 4}};
    const FacadeScene scene = facade_scene(*renderer, FacadeRenderer::kPatch, window_facade(), walls);
    constexpr int32_t kSide = 6 << 10, kHeight = 4 << 10;
    codec::mesh::MeshTile roof;
    add_quad(roof, {{{0, 0, kHeight}, {kSide, 0, kHeight}, {kSide, kSide, kHeight}, {0, kSide, kHeight}}}, {0, 0, 1},
             0);
    // The ground behind doors that reach down to it.
    add_quad(roof, {{{0, 0, 0}, {kSide, 0, 0}, {kSide, kSide, 0}, {0, kSide, 0}}}, {0, 0, 1}, 0);
    TileDraw tile = upload_tile(*renderer, roof, {});
    tile.facade = scene.tile.facade;
    tile.facade_maps = scene.tile.facade_maps;
    tile.map_of_placement = scene.tile.map_of_placement;
    tile.atlas = scene.tile.atlas;
    for (int i = 0; i < 24; ++i) {
        const double angle = i * 0.2617993878 + 0.01;
        const double distance = 9 + i % 5 * 7;
        const Vec3 position = {3 + distance * std::sin(angle), 3 + distance * std::cos(angle), 2.0 + i % 4};
        const double yaw = std::atan2(3 - position[0], 3 - position[1]) * 180 / 3.14159265358979323846;
        const Camera camera = make_camera(position, yaw, 0, 320, 240, 40);
        const FrameImage image = draw_or_fail(*renderer, camera, std::span(&tile, 1));
        if (i == 5) keep(image, "block");
        for (uint32_t y = 0; y < 240; ++y) {
            for (uint32_t x = 0; x < 320; ++x) {
                if (pixel(image, x, y) != std::array<int, 3>{255, 0, 255}) continue;
                // Inside the block's silhouette, shrunk a little: its side planes and its height.
                const Vec3 d = ray_through(camera, x + 0.5, y + 0.5);
                double enter = 0, leave = 1e9;
                for (size_t c = 0; c < 3; ++c) {
                    const double low = 0.02, high = c == 2 ? 3.68 : 5.98;
                    const double a = (low - camera.position[c]) / d[c], b = (high - camera.position[c]) / d[c];
                    enter = std::max(enter, std::min(a, b));
                    leave = std::min(leave, std::max(a, b));
                }
                ASSERT_GE(enter, leave) << "background shows at " << x << ", " << y << " of view " << i;
            }
        }
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

}  // namespace
}  // namespace citystream::client::test
