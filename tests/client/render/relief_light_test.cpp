// Facades whose relief shades itself: masks near, BTFs further away, the mean colour far off.
#include "client/render/relief_light.h"

#include "client/render/radiance_passes.h"
#include "codec/radiance/local_light.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/client/render/lit_house.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::client::test {
namespace {

RendererOptions meso_options(bool meso, uint32_t width = 160, uint32_t height = 120) {
    RendererOptions options = small_options(width, height);
    options.gpu_budget_bytes = 64 << 20;
    options.meso = meso;
    return options;
}

auto* const meso_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(meso_options(true))));
auto* const without_renderer =
    static_cast<SharedRenderer*>(testing::AddGlobalTestEnvironment(new SharedRenderer(meso_options(false))));

using LocalLightPassTest = GpuTwin;

TEST_F(LocalLightPassTest, GivesTheWordsOfTheCpu) {
    using namespace codec::radiance;
    const RadianceTile tile = LatticeScene::towers(32, 2, 7).tile(32, 12, 8);
    const auto layer = encode_radiance_layer(tile, 8, 1);
    ASSERT_TRUE(layer.ok());
    const LayerPrefix prefix(*layer, layer->size());
    const auto words = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, MatrixForm::kBiclusters);
    ASSERT_TRUE(words.ok());
    FrameLight light = light_of([](const Direction& d) -> Rgb {
        return {static_cast<float>(1.5 + d[0]), static_cast<float>(1.1 + d[1]), static_cast<float>(d[2] > 0 ? 40 : 0)};
    });
    std::vector<Rgb> radiance(texel_count(8), Rgb{0.5F, 0.1F, 0});
    radiance[100] = {1e5F, 3e4F, 2e3F};
    light.sky = whole_light(weighted_light(radiance, 8));
    const auto expected = local_light_words(*RadianceLayerView::create(*words), light.sky);
    ASSERT_FALSE(expected.empty());
    RadiancePasses passes(device_, pool_);
    passes.set_light(light);
    for (const bool scattered : {false, true}) {
        const LayerId id = upload_words(*words, scattered);
        const uint64_t slots = pool_.slots_used;
        ASSERT_TRUE(passes.plan(std::span(&id, 1), std::span(&id, 1)).ok());
        submit_and_wait(device_, [&](VkCommandBuffer commands) { passes.record(commands); });
        passes.finish();
        const LayerId local = passes.local_light(id);
        ASSERT_NE(local, kNoLayer);
        EXPECT_EQ(read_words(pool_, local, expected.size()), expected) << scattered;
        EXPECT_EQ(pool_.slots_used - slots, (expected.size() * 4 + kSlotBytes - 1) / kSlotBytes);
        // The same light again: nothing is to be done.
        ASSERT_TRUE(passes.plan(std::span(&id, 1), std::span(&id, 1)).ok());
        EXPECT_EQ(passes.counts().tiles, 0u);
        EXPECT_EQ(passes.local_light(id), local);
        passes.forget(id);
        EXPECT_EQ(pool_.slots_used, slots);
        EXPECT_EQ(passes.local_slots(), 0u);
    }
}

Rgb sky_radiance(const Direction& d) {
    if (d[2] < 0) return {0.1F, 0.1F, 0.1F};
    const double east = 0.5 + 0.5 * d[0];
    return {static_cast<float>(0.4 + 0.5 * east), static_cast<float>(0.5 + 0.2 * east + 0.2 * d[2]),
            static_cast<float>(0.5 + 0.6 * d[2])};
}

FrameLight sky_and_sun(bool sun) {
    FrameLight light = light_of(sky_radiance);
    if (sun) light.sun = Sun{{-0.48, -0.64, 0.6}, {1.4, 1.3, 1.2}, kSunRadius};
    return light;
}

/// What pixels of the house's facade show, by rays from each point of the relief to the sky and the sun.
class ReliefReference {
  public:
    ReliefReference(const House& house, const FrameLight& light)
        : house_(house),
          light_(light),
          painter_(std::span(&house.tile, 1), light),
          depths_(house.scene.grid.depths()) {}

    /// As light_of_pixel; none where the pixel does not show the facade.
    std::optional<Vec3> radiance(const FacadePainter& facade, const Camera& camera, double x, double y) const {
        const SeenPoint seen = facade.look(x, y);
        if (!std::isfinite(seen.distance)) return {};
        const Vec3 point = along(camera.position, ray_through(camera, x, y), seen.distance);
        // The wall's ends are seen through the facade's edges.
        if (std::abs(point[0] - 3) > 2.99 && std::abs(seen.normal[0]) > 0.5) return {};
        Vec3 sum = light_at(point, seen.normal);
        for (size_t c = 0; c < 3; ++c) sum[c] *= srgb_decoded(seen.texel[c] / 255);
        Vec3 shown = shown_light(sum);
        for (double& value : shown) value = srgb_decoded(value);
        return shown;
    }

  private:
    static constexpr uint32_t kRaysAcross = 12;

    /// Irradiance over pi.
    Vec3 light_at(const Vec3& point, const Vec3& normal) const {
        const Vec3 side = std::abs(normal[2]) > 0.5 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
        const Vec3 a = cross(normal, side), b = cross(normal, a);
        Vec3 sum{};
        for (uint32_t i = 0; i < kRaysAcross * kRaysAcross; ++i) {
            // Even over the disc below the hemisphere: each ray counts alike.
            const double r = std::sqrt((i / kRaysAcross + 0.5) / kRaysAcross);
            const double angle = 2 * pi() * (i % kRaysAcross + 0.5) / kRaysAcross;
            Vec3 d{};
            for (size_t c = 0; c < 3; ++c)
                d[c] = normal[c] * std::sqrt(1 - r * r) + r * (a[c] * std::cos(angle) + b[c] * std::sin(angle));
            if (!is_free(point, normal, d)) continue;
            const Rgb radiance = sky_radiance(d);
            for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(radiance[c]);
        }
        for (double& value : sum) value /= kRaysAcross * kRaysAcross;
        if (light_.sun && dot(normal, light_.sun->direction) > 0 && is_free(point, normal, light_.sun->direction)) {
            for (size_t c = 0; c < 3; ++c)
                sum[c] += light_.sun->irradiance[c] / pi() * dot(normal, light_.sun->direction);
        }
        return sum;
    }

    /// Neither the relief nor what stands in front of the wall hides the direction. The wall's lower left corner is the
    /// origin, it runs along x and faces -y.
    bool is_free(Vec3 point, const Vec3& normal, const Vec3& d) const {
        if (d[1] >= 0) return false;
        for (size_t c = 0; c < 3; ++c) point[c] += 1e-3 * normal[c];
        const codec::facade::RunGrid& grid = house_.scene.grid;
        const double u = grid.width() / house_.scene.wall.width(), v = grid.height() / house_.scene.wall.height;
        const double from[3] = {point[0] * u, point[2] * v, -point[1] * 1000};
        const double ray[3] = {d[0] * u, d[2] * v, -d[1] * 1000};
        if (codec::facade::cast_facade_ray(grid, depths_, from, ray).hit) return false;
        Vec3 begin = point[1] > 0 ? along(point, d, -point[1] / d[1]) : point;
        begin[1] = std::min(begin[1], 0.0) - 1e-3;
        return std::isinf(painter_.meeting(begin, d).t);
    }

    const House& house_;
    const FrameLight& light_;
    LitPainter painter_;
    codec::facade::DepthRange depths_;
};

FrameImage draw_with(VulkanRenderer& renderer, const House& house, const FrameLight& light, const Camera& camera) {
    EXPECT_TRUE(renderer.set_light(&light).ok());
    return draw_or_fail(renderer, camera, std::span(&house.scene.tile, 1));
}

/// Mean of what a picture shows of the facade, in light.
struct FacadeMean {
    Vec3 light{};
    uint32_t pixels = 0;
    double brightness() const { return (light[0] + light[1] + light[2]) / 3; }
};

/// The light that a pixel shows, bent as shown_light bends it.
Vec3 light_of_pixel(const std::array<int, 3>& shown) {
    return {srgb_decoded(shown[0] / 255.0), srgb_decoded(shown[1] / 255.0), srgb_decoded(shown[2] / 255.0)};
}

/// `step`: of the pixels that are looked at.
template <typename Light>
FacadeMean facade_mean(const House& house, const Camera& camera, uint32_t step, const Light& light) {
    const FacadePainter facade(house.scene, camera);
    FacadeMean mean;
    for (uint32_t y = 0; y < camera.height; y += step) {
        for (uint32_t x = 0; x < camera.width; x += step) {
            const std::optional<Vec3> here = light(facade, x, y);
            if (!here) continue;
            for (size_t c = 0; c < 3; ++c) mean.light[c] += (*here)[c];
            ++mean.pixels;
        }
    }
    for (double& value : mean.light) value /= std::max(mean.pixels, 1u);
    return mean;
}

FacadeMean mean_of(const House& house, const Camera& camera, const FrameImage& image) {
    return facade_mean(house, camera, 1, [&](const FacadePainter& facade, uint32_t x, uint32_t y) {
        const bool is_facade = std::isfinite(facade.look(x + 0.5, y + 0.5).distance);
        return is_facade ? std::optional<Vec3>(light_of_pixel(pixel(image, x, y))) : std::nullopt;
    });
}

/// Root of the mean squared difference of light between a picture and the reference, over the reference's mean.
double error_against(const ReliefReference& reference, const House& house, const Camera& camera,
                     const FrameImage& image) {
    double squares = 0;
    const FacadeMean mean =
        facade_mean(house, camera, 3, [&](const FacadePainter& facade, uint32_t x, uint32_t y) -> std::optional<Vec3> {
            const auto expected = reference.radiance(facade, camera, x + 0.5, y + 0.5);
            if (!expected) return {};
            const Vec3 shown = light_of_pixel(pixel(image, x, y));
            for (size_t c = 0; c < 3; ++c) squares += ((*expected)[c] - shown[c]) * ((*expected)[c] - shown[c]) / 3;
            return expected;
        });
    return std::sqrt(squares / mean.pixels) / mean.brightness();
}

/// One colour for each palette slot: what changes is light.
std::vector<codec::atlas::ChartImage> plain_charts() {
    std::vector<codec::atlas::ChartImage> charts = test_charts();
    for (size_t i = 0; i < charts.size(); ++i) {
        for (size_t k = 0; k < charts[i].rgb.size(); ++k)
            charts[i].rgb[k] = static_cast<uint8_t>(170 - 15 * i - 20 * (k % 3));
    }
    return charts;
}

const House& shared_house() {
    static const House kHouse = make_house(*meso_renderer->get(), window_facade(), plain_charts());
    return kHouse;
}

TEST(ReliefLight, NearReliefShowsWhatRaysFromItReach) {
    VulkanRenderer *const renderer = meso_renderer->get(), *const without = without_renderer->get();
    ASSERT_NE(renderer, nullptr);
    ASSERT_NE(without, nullptr);
    const House& house = shared_house();
    const House same = make_house(*without, window_facade(), plain_charts());
    const Camera cameras[] = {make_camera({3, -5, 2}, 0, 0, 160, 120), make_camera({7, -2.5, 1.3}, -50, 10, 160, 120)};
    for (const bool sun : {false, true}) {
        const FrameLight light = sky_and_sun(sun);
        const ReliefReference reference(house, light);
        for (const Camera& camera : cameras) {
            const FrameImage image = draw_with(*renderer, house, light, camera);
            EXPECT_EQ(renderer->counts().relief_masks, 1u);
            EXPECT_EQ(renderer->counts().facades_cast, 1u);
            EXPECT_GT(renderer->counts().local_light_bytes, 0u);
            keep(image, sun ? "meso_near_sun" : "meso_near");
            const FrameImage plain = draw_with(*without, same, light, camera);
            keep(plain, sun ? "meso_off_sun" : "meso_off");
            const double with_mask = error_against(reference, house, camera, image);
            const double without_mask = error_against(reference, house, camera, plain);
            EXPECT_LT(with_mask, 0.6 * without_mask);
            EXPECT_LT(with_mask, 0.35);
        }
    }
    EXPECT_EQ(without->counts().relief_masks + without->counts().local_light_bytes, 0u);
    EXPECT_EQ(renderer->validation_messages() + without->validation_messages(), 0U);
}

// Near by masks, further away by BTFs: both are lit by the light of the ancestor's receivers by direction.
TEST(ReliefLight, ATileLitByAnAncestorsReceiversShowsWhatItsOwnShow) {
    VulkanRenderer* const renderer = meso_renderer->get();
    ASSERT_NE(renderer, nullptr);
    const House& house = shared_house();
    const TileDraw inheriting = inheriting_tile(*renderer, house);
    TileDraw misplaced = inheriting;
    misplaced.radiance_offset = {};
    const FrameLight light = sky_and_sun(false);
    ASSERT_TRUE(renderer->set_light(&light).ok());
    uint64_t cast = 0, by_btf = 0;
    for (const double distance : {5.0, 60.0}) {
        const Camera camera = make_camera({3, -distance, 2}, 0, 0, 160, 120, 40);
        const FrameImage own = draw_or_fail(*renderer, camera, std::span(&house.scene.tile, 1));
        const FrameImage inherited = draw_or_fail(*renderer, camera, std::span(&inheriting, 1));
        cast += renderer->counts().facades_cast;
        by_btf += renderer->counts().facades_by_btf;
        EXPECT_GT(renderer->counts().local_light_bytes, 0u);
        EXPECT_LE(greatest_difference(own, inherited), 1) << distance;
        const FrameImage wrong = draw_or_fail(*renderer, camera, std::span(&misplaced, 1));
        EXPECT_GT(greatest_difference(own, wrong), 20) << distance;
    }
    EXPECT_EQ(cast, 1u);
    EXPECT_EQ(by_btf, 1u);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

// From 6 m to 150 m: the facade goes from the mask to the BTF to its mean colour. With five samples a pixel: the bars
// of a wall of 30 pixels under one sample come and go by themselves.
TEST(ReliefLight, FlyingBackFromAWallShowsNoJump) {
    RendererOptions options = meso_options(true);
    options.facade_samples = 5;
    const auto sampling = VulkanRenderer::create(options);
    ASSERT_TRUE(sampling.ok()) << sampling.error().text();
    VulkanRenderer* const renderer = sampling->get();
    const House house = make_house(*renderer, window_facade(), plain_charts());
    const FrameLight light = sky_and_sun(true);
    const ReliefReference reference(house, light);
    double before = 0;
    std::array<uint64_t, 3> ways{};
    constexpr uint32_t kFrames = 66;
    double distance = 6;
    for (uint32_t frame = 0; frame < kFrames; ++frame, distance *= 1.05) {
        const Camera camera = make_camera({2, -distance, 2}, 2, 0, 160, 120, 40);
        const FrameImage image = draw_with(*renderer, house, light, camera);
        ways[0] += renderer->counts().facades_cast;
        ways[1] += renderer->counts().facades_by_btf;
        ways[2] += renderer->counts().facades_by_mean;
        if (frame % 8 == 0) keep(image, "meso_back_" + std::to_string(frame / 8));
        const FacadeMean mean = mean_of(house, camera, image);
        // Of few pixels the mean changes as they come and go.
        const bool is_sure = mean.pixels >= 150;
        if (frame > 0) {
            EXPECT_NEAR(mean.brightness() / before, 1, is_sure ? 0.03 : 0.12) << distance;
        }
        before = mean.brightness();
        if (frame % 16 != 0) continue;
        const auto rays = [&](const FacadePainter& facade, uint32_t x, uint32_t y) {
            return reference.radiance(facade, camera, x + 0.5, y + 0.5);
        };
        const double expected = facade_mean(house, camera, distance > 12 ? 1 : 3, rays).brightness();
        EXPECT_NEAR(mean.brightness() / expected, 1, is_sure ? 0.06 : 0.2) << distance;
    }
    for (size_t way = 0; way < ways.size(); ++way) EXPECT_GE(ways[way], 3u) << way;
    EXPECT_EQ(renderer->counts().btfs, 1u);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(ReliefLight, WallsWithoutReliefShowWhatTheyShowWithoutMasksAndBtfs) {
    VulkanRenderer *const renderer = meso_renderer->get(), *const without = without_renderer->get();
    ASSERT_NE(renderer, nullptr);
    ASSERT_NE(without, nullptr);
    const codec::facade::FacadeMatrices flat{600, 400, std::vector<int16_t>(240000, 0),
                                             std::vector<uint16_t>(240000, 1)};
    const auto grid = codec::facade::make_run_grid(flat);
    ASSERT_TRUE(grid.ok());
    const House house = make_house(*renderer, *grid), same = make_house(*without, *grid);
    const FrameLight light = sky_and_sun(true);
    for (const double distance : {5.0, 12.0, 24.0, 60.0, 120.0}) {
        const Camera camera = make_camera({4, -distance, 2}, -4, 0, 160, 120, 40);
        const FrameImage a = draw_with(*renderer, house, light, camera);
        const FrameImage b = draw_with(*without, same, light, camera);
        uint32_t pixels = 0, worst = 0;
        const FacadePainter facade(house.scene, camera);
        for (uint32_t y = 0; y < camera.height; ++y) {
            for (uint32_t x = 0; x < camera.width; ++x) {
                if (!std::isfinite(facade.look(x + 0.5, y + 0.5).distance)) continue;
                ++pixels;
                for (size_t c = 0; c < 3; ++c)
                    worst = std::max(worst, static_cast<uint32_t>(std::abs(pixel(a, x, y)[c] - pixel(b, x, y)[c])));
            }
        }
        EXPECT_GT(pixels, 10u);
        EXPECT_LE(worst, 3u) << distance;
    }
}

TEST(ReliefLight, NothingIsMadeWithoutALight) {
    VulkanRenderer *const renderer = meso_renderer->get(), *const without = without_renderer->get();
    ASSERT_NE(renderer, nullptr);
    ASSERT_NE(without, nullptr);
    const Camera camera = make_camera({3, -5, 2}, 0, 0, 160, 120);
    const House house = make_house(*renderer), same = make_house(*without);
    ASSERT_TRUE(renderer->set_light(nullptr).ok());
    ASSERT_TRUE(without->set_light(nullptr).ok());
    const uint64_t slots = renderer->slots_used();
    EXPECT_EQ(draw_or_fail(*renderer, camera, std::span(&house.scene.tile, 1)).rgba,
              draw_or_fail(*without, camera, std::span(&same.scene.tile, 1)).rgba);
    EXPECT_EQ(renderer->slots_used(), slots);
    EXPECT_EQ(renderer->counts().local_light_bytes + renderer->counts().facades_cast, 0u);
}

TEST(ReliefLight, LayersComeBeforeMasksAndLocalLight) {
    RendererOptions options = meso_options(true);
    options.gpu_budget_bytes = 4 << 20;
    options.btf_budget_bytes = 1 << 10;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    const House house = make_house(*renderer);
    const FrameLight light = sky_and_sun(false);
    draw_with(*renderer, house, light, make_camera({3, -5, 2}, 0, 0, 160, 120));
    EXPECT_EQ(renderer->counts().relief_masks, 1u);
    draw_with(*renderer, house, light, make_camera({3, -30, 2}, 0, 0, 160, 120));
    EXPECT_EQ(renderer->counts().btfs, 0u) << "there is no room for one";
    // All that the budget has left goes to a layer.
    const uint64_t free = renderer->slot_count() - renderer->slots_used();
    const LayerId layer = renderer->create();
    ASSERT_TRUE(renderer->append(layer, std::vector<uint32_t>(free * kSlotBytes / 4)).ok());
    EXPECT_EQ(renderer->slots_used(), renderer->slot_count());
    draw_with(*renderer, house, light, make_camera({3, -5, 2}, 0, 0, 160, 120));
    EXPECT_EQ(renderer->counts().relief_masks, 0u);
    EXPECT_EQ(renderer->counts().local_light_bytes, 0u);
    EXPECT_EQ(renderer->validation_messages(), 0U);
}

TEST(ReliefLight, WallsAreReadFromWordsThatHoldThemAll) {
    codec::facade::FacadeTile tile;
    tile.placements.push_back({{1024, 2048, -512}, {3072, 0}, 4096, 0, 0});
    tile.palettes.emplace_back();
    const std::vector<uint32_t> words = joined(codec::facade::encode_facades(tile));
    const auto walls = relief_walls(words);
    ASSERT_EQ(walls.size(), 1u);
    EXPECT_EQ(walls[0].corner, (std::array<double, 3>{1, 2, -0.5}));
    EXPECT_EQ(walls[0].along, (std::array<double, 2>{3, 0}));
    EXPECT_EQ(walls[0].height, 4);
    for (size_t count = 0; count < words.size() - 1; ++count) {
        const auto cut = relief_walls(std::span(words).first(count));
        EXPECT_LE(cut.size(), 1u);
    }
    std::vector<uint32_t> wrong = words;
    wrong[FACADE_LAYER_WORD_PLACEMENT_COUNT] = 0xffffffff;
    EXPECT_TRUE(relief_walls(wrong).empty());
    wrong = words;
    wrong[FACADE_LAYER_WORD_PLACEMENTS] = 0xffffffff;
    EXPECT_TRUE(relief_walls(wrong).empty());

    // 3 m wide and 4 m high, seen from 8 m in front by 60 degrees in 100 pixels.
    const Camera camera = make_camera({2.5, -6, 0}, 0, 0, 100, 100, 60);
    const WallPixels pixels = wall_pixels(walls[0], {0, 0, 0}, camera, 100);
    EXPECT_NEAR(pixels.most, 4 / (8 * 2 * std::tan(pi() / 6)) * 100, 1e-9);
    EXPECT_NEAR(pixels.least, pixels.most, 1e-9);
    EXPECT_EQ(wall_pixels(walls[0], {0, 0, 0}, make_camera({2.5, 12, 0}, 180, 0, 100, 100, 60), 100).most, 0)
        << "from behind";
    EXPECT_EQ(wall_pixels(walls[0], {0, 0, 0}, make_camera({2.5, -6, 0}, 180, 0, 100, 100, 60), 100).most, 0)
        << "looking away";
}

}  // namespace
}  // namespace citystream::client::test
