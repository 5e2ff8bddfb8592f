// What is seen of a level that arrives: a camera comes nearer to a textured city of flat roofs, and frames just before
// and just behind the places where something finer arrives are compared.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "tests/programs/block_city.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using namespace client;

/// What is drawn: tiles, and how fine they are.
struct Drawn {
    std::vector<std::tuple<std::array<double, 3>, size_t>> tiles;  ///< place, mesh steps
    std::vector<uint32_t> mips;
    friend bool operator==(const Drawn&, const Drawn&) = default;
};

Drawn drawn_of(const std::vector<TileDraw>& draws) {
    Drawn drawn;
    for (const TileDraw& draw : draws) {
        drawn.tiles.emplace_back(draw.origin, draw.mesh_steps);
        drawn.mips.push_back(draw.atlas_finest_mip);
        for (const SharedChartBinding& chart : draw.shared_charts) drawn.mips.push_back(chart.finest_mip);
    }
    return drawn;
}

double difference(const FrameImage& a, const FrameImage& b) {
    double sum = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(static_cast<double>(a.rgba[i]) - b.rgba[i], 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

/// What the greatest change at one place of the path is, levels of 255 (root mean square), where only texels became
/// finer and where tiles or meshes did, and what the same movement changes beside these places.
struct Pops {
    double texels = 0, tiles = 0, beside = 0;
    int texel_switches = 0, tile_switches = 0;
};

void say(const char* name, const Pops& pops) {
    std::printf("%s: texels %.4f in %d switches, tiles %.4f in %d, beside them %.4f\n", name, pops.texels,
                pops.texel_switches, pops.tiles, pops.tile_switches, pops.beside);
}

class Pop : public testing::Test {
  protected:
    static constexpr uint32_t kWidth = 480, kHeight = 270;
    static constexpr int kStretches = 40;
    static constexpr double kNear = 1e-6;  ///< of the path: 4e-6 of the distance

    /// Where charts are shared a tile shows them as fine as its children do, which it then never needs.
    void build(const std::string& sharing) {
        write_file(folder_ / "noise.tga", noise_texture());
        write_file(folder_ / "city.json", block_city());
        const Outcome built =
            run({program("citystream-build"), folder_ / "city.json", "-o", folder_ / "city.3tz", "--rate-distortion",
                 "0", "--texture-law", "0.02,8,4", "--shared-charts", sharing, "--json"});
        ASSERT_EQ(built.exit_code, 0) << built.error;
        RendererOptions options;
        options.width = kWidth;
        options.height = kHeight;
        options.supersample = 1;
        auto renderer = VulkanRenderer::create(options);
        ASSERT_TRUE(renderer) << renderer.error().text();
        renderer_ = std::move(*renderer);
    }

    /// From 500 m before the city (0) to 6 m before its first wall (1).
    static Camera camera(double place) {
        CameraSample sample;
        sample.x = 500 + kBlocks / 2 * kBlockPitch + 40;
        sample.y = 500 - 500 * std::exp(-place * std::log(80.0));
        sample.z = 24;
        sample.fov = 50;
        return Camera::from_sample(sample, kWidth, kHeight);
    }

    void open(double tolerance, bool continuous) {
        streamer_.reset();
        fetcher_ = std::move(*Fetcher::open(folder_ / "city.3tz", FetcherOptions{}));
        StreamerOptions options;
        options.tolerance_pixels = tolerance;
        options.continuous_mips = continuous;
        auto streamer = CityStreamer::open(*fetcher_, *renderer_, options);
        ASSERT_TRUE(streamer.ok());
        streamer_ = std::move(*streamer);
    }

    const std::vector<TileDraw>& draws(double place) {
        StreamerFrame frame;
        return streamer_->update(camera(place), frame);
    }

    FrameImage picture(double place) {
        auto image = renderer_->draw(camera(place), draws(place), nullptr);
        EXPECT_TRUE(image.ok());
        return std::move(*image);
    }

    Pops pops(double tolerance, bool continuous) {
        open(tolerance, continuous);
        Pops pops;
        for (int i = 0; i < kStretches; ++i) {
            double before = static_cast<double>(i) / kStretches, behind = static_cast<double>(i + 1) / kStretches;
            const Drawn first = drawn_of(draws(before));
            if (first == drawn_of(draws(behind))) continue;
            while (behind - before > kNear) {
                const double middle = (before + behind) / 2;
                (drawn_of(draws(middle)) == first ? before : behind) = middle;
            }
            const bool texels = first.tiles == drawn_of(draws(behind)).tiles;
            const FrameImage far = picture(before), near = picture(behind);
            double& greatest = texels ? pops.texels : pops.tiles;
            greatest = std::max(greatest, difference(far, near));
            ++(texels ? pops.texel_switches : pops.tile_switches);
            pops.beside = std::max(pops.beside, difference(picture(before - (behind - before)), far));
        }
        return pops;
    }

    TemporaryFolder folder_;
    std::unique_ptr<VulkanRenderer> renderer_;
    std::unique_ptr<Fetcher> fetcher_;
    std::unique_ptr<CityStreamer> streamer_;
};

TEST_F(Pop, AtOnePixelTheClampChangesNotABit) {
    build("on");
    for (const double place : {0.0, 0.31, 0.62, 0.8, 0.97}) {
        open(1, true);
        const FrameImage with = picture(place);
        open(1, false);
        EXPECT_EQ(with.rgba, picture(place).rgba) << place;
    }
}

TEST_F(Pop, FinerTexelsAreNotSeenToArrive) {
    build("on");
    const Pops near = pops(1, true), far = pops(4, true), stepped = pops(4, false);
    say("shared charts, 1 px", near);
    say("shared charts, 4 px", far);
    say("shared charts, 4 px in steps", stepped);
    ASSERT_GT(far.texel_switches, 2);
    EXPECT_LT(near.texels, 0.2);
    EXPECT_LT(far.texels, 0.2);
    EXPECT_GT(stepped.texels, 2) << "the test sees steps where there are some";
}

TEST_F(Pop, ChildrenAreNotSeenToTakeOver) {
    build("off");
    const Pops near = pops(1, true), far = pops(4, true), stepped = pops(4, false);
    say("own charts, 1 px", near);
    say("own charts, 4 px", far);
    say("own charts, 4 px in steps", stepped);
    ASSERT_GT(far.tile_switches, 0);
    EXPECT_LT(far.texels, 0.2);
    EXPECT_LT(far.tiles, 0.2);
    EXPECT_GT(stepped.tiles, 2);
}

}  // namespace
}  // namespace citystream::tests
