// Relief smaller than a pixel: frames that take several rays a pixel against those that take one, and what a change of
// level shows.
#include "client/select/placement_levels.h"
#include "codec/facade/facade_levels.h"
#include "tests/client/render/facade_scene.h"

namespace citystream::client::test {
namespace {

constexpr uint32_t kWidth = 120, kHeight = 80;

std::unique_ptr<VulkanRenderer> renderer_with(uint32_t samples, FacadeRenderer kind = FacadeRenderer::kPatch) {
    RendererOptions options = small_options(kWidth, kHeight);
    options.gpu_budget_bytes = 64 << 20;
    options.facade_renderer = kind;
    options.facade_samples = samples;
    return make_renderer(options);
}

/// 24 x 16 m of windows with bars and frames of 6 cm and sills.
codec::facade::RunGrid make_windows() {
    codec::facade::FacadeMatrices matrices{2400, 1600, std::vector<int16_t>(3840000, 0),
                                           std::vector<uint16_t>(3840000, 0)};
    const auto box = [&](uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, int depth, uint32_t slot) {
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                matrices.displacement_mm[size_t{y} * 2400 + x] = static_cast<int16_t>(depth);
                matrices.material[size_t{y} * 2400 + x] = static_cast<uint16_t>(slot);
            }
        }
    };
    for (uint32_t y = 90; y + 200 < 1600; y += 300) {
        for (uint32_t x = 70; x + 150 < 2400; x += 230) {
            box(x - 10, y - 12, x + 136, y, 120, 2);
            box(x, y, x + 126, y + 166, -60, 2);
            box(x + 6, y + 6, x + 60, y + 160, -220, 3);
            box(x + 66, y + 6, x + 120, y + 160, -220, 3);
        }
    }
    return *codec::facade::make_run_grid(matrices);
}

const codec::facade::RunGrid& windows() {
    static const codec::facade::RunGrid grid = make_windows();
    return grid;
}

/// Plaster, two kinds of frames, glass: without texture, so that relief alone is judged.
std::vector<codec::atlas::ChartImage> paints() {
    std::vector<codec::atlas::ChartImage> charts(4, test_chart(4, 4));
    const std::array<uint8_t, 3> colours[4] = {{200, 170, 120}, {60, 60, 60}, {240, 240, 235}, {40, 55, 75}};
    for (size_t c = 0; c < charts.size(); ++c) {
        for (size_t i = 0; i < charts[c].rgb.size(); ++i) charts[c].rgb[i] = colours[c][i % 3];
    }
    return charts;
}

const Wall kWall = {{0, 0, 0}, {24, 0}, 16};

/// Seen obliquely from 90 m, a pixel 10 cm wide; moved by some tenths of a pixel a frame.
Camera dolly(uint32_t frame) {
    const double moved = 0.034 * frame;
    return make_camera({-38 + moved, -80, 3 + 0.4 * moved}, 31, 3.2, kWidth, kHeight, 5.1);
}

using Picture = std::vector<double>;  ///< channels of pixels

Picture channels(const FrameImage& image) {
    Picture out;
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        if (i % 4 != 3) out.push_back(image.rgba[i]);
    }
    return out;
}

/// The mean over a grid of rays a pixel.
Picture area_filtered(const FacadeScene& scene, const Camera& camera) {
    constexpr int kSide = 6;
    const FacadePainter painter(scene, camera);
    Picture out;
    for (uint32_t y = 0; y < camera.height; ++y) {
        for (uint32_t x = 0; x < camera.width; ++x) {
            Vec3 sum{};
            for (int i = 0; i < kSide * kSide; ++i) {
                const SeenPoint seen =
                    painter.look(x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide, 1.0 / kSide);
                const Vec3 colour = std::isfinite(seen.distance) ? seen.colour : kSkyColour;
                for (size_t c = 0; c < 3; ++c) sum[c] += colour[c] / (kSide * kSide);
            }
            out.insert(out.end(), sum.begin(), sum.end());
        }
    }
    return out;
}

double mean_square(const Picture& a, const Picture& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum / static_cast<double>(a.size());
}

class SampledFacade : public testing::TestWithParam<std::pair<FacadeRenderer, uint32_t>> {};

TEST_P(SampledFacade, LooksLikeTheSameSamplesCastOnTheCpu) {
    const auto [kind, samples] = GetParam();
    const auto renderer = renderer_with(samples, kind);
    ASSERT_NE(renderer, nullptr);
    const FacadeScene scene = facade_scene(*renderer, kind, windows(), std::span(&kWall, 1));
    const std::string name = std::string(facade_renderer_name(kind)) + "_" + std::to_string(samples);
    for (const auto& [view, camera] :
         {std::pair("oblique", dolly(0)), std::pair("whole", make_camera({12, -60, 8}, 0, 0, kWidth, kHeight, 20)),
          std::pair("grazing", make_camera({-60, -4, 5}, 86, 0, kWidth, kHeight, 10)),
          std::pair("near", make_camera({3, -3, 2}, 20, 0, kWidth, kHeight, 60))}) {
        const FrameImage gpu = draw_or_fail(*renderer, camera, std::span(&scene.tile, 1));
        const FrameImage cpu = cast_facade_picture(scene, camera, samples);
        keep(gpu, name + "_" + view + "_gpu");
        keep(cpu, name + "_" + view + "_cpu");
        EXPECT_GT(psnr(gpu, cpu), 35.0) << name << " " << view;
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Renderers, SampledFacade,
                         testing::Values(std::pair(FacadeRenderer::kPatch, 5u), std::pair(FacadeRenderer::kPatch, 13u),
                                         std::pair(FacadeRenderer::kMaxMip, 5u), std::pair(FacadeRenderer::kFdm, 5u)),
                         [](const auto& row) {
                             std::string name(facade_renderer_name(row.param.first));
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name + "_" + std::to_string(row.param.second);
                         });

/// Over a dolly: mean square error, and mean square of changes from frame to frame that the filtered pictures have not.
struct Shimmer {
    double error = 0, noise = 0;
};

Shimmer shimmer_of(uint32_t samples, std::span<const Picture> references) {
    const auto renderer = renderer_with(samples);
    if (renderer == nullptr) return {};
    const FacadeScene scene =
        facade_scene(*renderer, FacadeRenderer::kPatch, windows(), std::span(&kWall, 1), paints());
    Shimmer shimmer;
    Picture error_before;
    for (uint32_t i = 0; i < references.size(); ++i) {
        const FrameImage image = draw_or_fail(*renderer, dolly(i), std::span(&scene.tile, 1));
        if (i == 0) keep(image, "dolly_" + std::to_string(samples));
        Picture error = channels(image);
        shimmer.error += mean_square(error, references[i]) / static_cast<double>(references.size());
        for (size_t c = 0; c < error.size(); ++c) error[c] -= references[i][c];
        if (i > 0) shimmer.noise += mean_square(error, error_before) / static_cast<double>(references.size() - 1);
        error_before = std::move(error);
    }
    EXPECT_EQ(renderer->validation_messages(), 0u);
    return shimmer;
}

TEST(FacadeShimmer, FarReliefIsNearerToTheFilteredPictureAndStillerWithMoreRays) {
    const auto renderer = renderer_with(1);
    ASSERT_NE(renderer, nullptr);
    const FacadeScene scene =
        facade_scene(*renderer, FacadeRenderer::kPatch, windows(), std::span(&kWall, 1), paints());
    std::vector<Picture> references;
    for (uint32_t i = 0; i < 6; ++i) references.push_back(area_filtered(scene, dolly(i)));
    const Shimmer one = shimmer_of(1, references), five = shimmer_of(5, references), most = shimmer_of(13, references);
    std::printf("mean square error and temporal noise: 1 ray %.1f %.1f, 5 rays %.1f %.1f, 13 rays %.1f %.1f\n",
                one.error, one.noise, five.error, five.noise, most.error, most.noise);
    EXPECT_GT(one.error, 50) << "the view has nothing to filter: the test is too easy";
    EXPECT_LT(five.error, one.error / 5);
    EXPECT_LT(five.noise, one.noise / 5);
    EXPECT_LT(most.error, five.error);
    EXPECT_LT(most.noise, five.noise);
}

/// The distance beyond which a level with texels of 4 cm is taken for the exact one.
double switch_distance(const Camera& camera) {
    tiles::tileset::FacadeMapRecord record;
    for (const int texel : {4, 1}) record.level[record.level_count++].texel_cm = static_cast<uint16_t>(texel);
    FacadeDictionary dictionary;
    dictionary.learn({record});
    double near = 1, far = 10000;
    for (int i = 0; i < 40; ++i) {
        const double middle = (near + far) / 2;
        Camera moved = camera;
        moved.position = {kWall.corner[0] + kWall.along[0] / 2, kWall.corner[1] - middle, 1};
        const codec::facade::Placement wall = kWall.placement(0);
        const auto levels = placement_levels(dictionary, moved, {}, std::span(&wall, 1), {kTexelShare, {}});
        (level_of(levels[0].piece) == 0 ? far : near) = middle;
    }
    return far;
}

// From one frame to the next, at the distance where the client takes the coarser level.
TEST(FacadeShimmer, AChangeOfLevelShowsLessThanAMoveByATenthOfAPixel) {
    const auto renderer = renderer_with(kTestedSamples);
    ASSERT_NE(renderer, nullptr);
    const FacadeScene exact =
        facade_scene(*renderer, FacadeRenderer::kPatch, windows(), std::span(&kWall, 1), paints());
    const FacadeScene coarse = facade_scene(*renderer, FacadeRenderer::kPatch, codec::facade::coarsen(windows(), 4),
                                            std::span(&kWall, 1), paints());
    Camera camera = make_camera({12, 0, 8}, 0, 0, kWidth, kHeight, 25);
    const double distance = switch_distance(camera);
    EXPECT_NEAR(camera.pixels_per_metre(distance) * 0.04, kTexelShare, 1e-3);
    camera.position[1] = -distance;
    Camera moved = camera;
    moved.position[0] += 0.1 / camera.pixels_per_metre(distance);
    const auto draw = [&](const FacadeScene& scene, const Camera& from) {
        return draw_or_fail(*renderer, from, std::span(&scene.tile, 1));
    };
    const FrameImage before = draw(exact, camera), after = draw(coarse, camera);
    keep(before, "switch_before");
    keep(after, "switch_after");
    const double pop = mean_square(channels(before), channels(after));
    const double move = mean_square(channels(before), channels(draw(exact, moved)));
    std::printf("root mean square of a change of level %.2f, of a move by a tenth of a pixel %.2f\n", std::sqrt(pop),
                std::sqrt(move));
    EXPECT_LT(pop, move);
}

}  // namespace
}  // namespace citystream::client::test
