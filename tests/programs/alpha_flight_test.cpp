// Fences and trees cut out by alpha, from image files to pictures: what is seen through them and how much of them is
// seen, from near and far, beside the reference renderer's pictures of the same city.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "client/reference/reference_renderer.h"
#include "client/render/frame_file.h"
#include "client/render/lighting_layout.h"
#include "client/render/vulkan_renderer.h"
#include "client/report/image_metrics.h"
#include "client/stream/city_streamer.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using namespace client;
using nlohmann::json;

constexpr double kFenceShare = 1 - std::pow(1 - 3.0 / 16, 2);  // of bars 3 of 16 texels wide, both ways

bool in_fence(double u, double v) {
    return std::fmod(u * 8, 1.0) < 3.0 / 16 || std::fmod(v * 8, 1.0) < 3.0 / 16;
}

bool in_tree(double u, double v) {
    const double x = u - 0.5, y = v - 0.62;
    const bool leaves = std::sin(47 * u + 17 * v) * std::sin(39 * v - 23 * u) > -0.25;
    return (x * x * 4.5 + y * y * 7 < 1 && leaves) || (std::abs(x) < 0.04 && v < 0.35);
}

/// An uncompressed TGA file of 128 x 128 pixels: green where the shape is, magenta and transparent elsewhere.
std::string cut_out(const std::function<bool(double, double)>& shape) {
    constexpr int kSide = 128;
    std::string file(18, '\0');
    file[2] = 2;  // true colour
    file[12] = static_cast<char>(kSide);
    file[14] = static_cast<char>(kSide);
    file[16] = 32;
    file[17] = 8;  // bits of alpha; rows from the bottom up
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const bool there = shape((x + 0.5) / kSide, (y + 0.5) / kSide);
            file += there ? std::string("\x1e\xa0\x14\xff", 4) : std::string("\xff\x00\xff\x00", 4);  // B, G, R, A
        }
    }
    return file;
}

/// An upright quad from (x0, y0) to (x1, y1), facing south where x grows.
struct Quad {
    std::string type;
    std::array<double, 4> foot;
    double height;
    int texture;  ///< -1: none
    double repeats_u, repeats_v;
};

/// A fence of 24 x 2 m, two trees of crossed pictures, and a white wall of 60 x 20 m behind them; side x side times,
/// to the east and to the north.
std::string city_json(int side) {
    const std::vector<Quad> one = {{"CityFurniture", {-12, 0, 12, 0}, 2, 0, 12, 1},
                                   {"SolitaryVegetationObject", {-7, 4, -1, 4}, 8, 1, 1, 1},
                                   {"SolitaryVegetationObject", {-4, 1, -4, 7}, 8, 1, 1, 1},
                                   {"SolitaryVegetationObject", {2, 6, 8, 6}, 8, 1, 1, 1},
                                   {"Building", {-30, 12, 30, 12}, 20, -1, 1, 1}};
    std::vector<Quad> quads;
    for (int i = 0; i < side * side; ++i) {
        const double east = 70.0 * (i % side), north = 40.0 * (i / side);
        for (Quad quad : one) {
            const auto& f = quad.foot;
            quad.foot = {f[0] + east, f[1] + north, f[2] + east, f[3] + north};
            quads.push_back(quad);
        }
    }
    json city = {{"type", "CityJSON"}, {"version", "2.0"}};
    json vertices = json::array(), places = json::array(), objects = json::object();
    for (const Quad& quad : quads) {
        const size_t v = vertices.size(), t = places.size();
        const auto& f = quad.foot;
        for (const auto& [x, y, z] : {std::array{f[0], f[1], 0.0}, std::array{f[2], f[3], 0.0},
                                      std::array{f[2], f[3], quad.height}, std::array{f[0], f[1], quad.height}})
            vertices.push_back({static_cast<int>(x * 1000), static_cast<int>(y * 1000), static_cast<int>(z * 1000)});
        for (const auto& [a, b] : {std::array{0.0, 0.0}, std::array{quad.repeats_u, 0.0},
                                   std::array{quad.repeats_u, quad.repeats_v}, std::array{0.0, quad.repeats_v}})
            places.push_back({a, b});
        json geometry = {{"type", "MultiSurface"}, {"lod", "2"}, {"boundaries", {{{v, v + 1, v + 2, v + 3}}}}};
        if (quad.texture >= 0) {
            geometry["texture"]["t"]["values"] = {{{quad.texture, t, t + 1, t + 2, t + 3}}};
        } else {
            geometry["material"]["t"]["value"] = 0;
        }
        objects["o" + std::to_string(v)] = {{"type", quad.type}, {"geometry", json::array({geometry})}};
    }
    city["transform"] = {{"scale", {0.001, 0.001, 0.001}}, {"translate", {500.0, 500.0, 0.0}}};
    city["vertices"] = vertices;
    city["CityObjects"] = objects;
    city["appearance"] = {{"textures",
                           {{{"type", "TGA"}, {"image", "fence.tga"}, {"wrapMode", "wrap"}},
                            {{"type", "TGA"}, {"image", "tree.tga"}, {"wrapMode", "border"}}}},
                          {"materials", {{{"name", "white"}, {"diffuseColor", {1.0, 1.0, 1.0}}}}},
                          {"vertices-texture", places}};
    return city.dump();
}

class AlphaFlight : public testing::Test {
  protected:
    static constexpr uint32_t kWidth = 480, kHeight = 270;

    void SetUp() override {
        write_file(folder_ / "fence.tga", cut_out(in_fence));
        write_file(folder_ / "tree.tga", cut_out(in_tree));
        build(1);
    }

    /// The builder's summary.
    json build(int side, const std::vector<std::string>& more = {}) {
        write_file(folder_ / "city.json", city_json(side));
        std::vector<std::string> command = {program("citystream-build"),
                                            folder_ / "city.json",
                                            "-o",
                                            folder_ / "city.3tz",
                                            "--reference",
                                            folder_ / "city.glb",
                                            "--json"};
        command.insert(command.end(), more.begin(), more.end());
        const Outcome built = run(command);
        EXPECT_EQ(built.exit_code, 0) << built.error;
        return built.exit_code == 0 ? json::parse(built.output) : json();
    }

    static Camera camera(double distance, double height) {
        CameraSample sample;
        sample.x = 500;
        sample.y = 500 - distance;
        sample.z = height;
        sample.fov = 50;
        return Camera::from_sample(sample, kWidth, kHeight);
    }

    FrameImage ours(const Camera& camera, double tolerance = 1) {
        if (!renderer_) {
            RendererOptions options;
            options.width = kWidth;
            options.height = kHeight;
            options.supersample = 4;
            auto renderer = VulkanRenderer::create(options);
            EXPECT_TRUE(renderer) << renderer.error().text();
            renderer_ = std::move(*renderer);
            fetcher_ = std::move(*Fetcher::open(folder_ / "city.3tz", FetcherOptions{}));
            auto streamer = CityStreamer::open(*fetcher_, *renderer_, {});
            EXPECT_TRUE(streamer) << streamer.error().text();
            streamer_ = std::move(*streamer);
        }
        streamer_->set_tolerance(tolerance);
        StreamerFrame frame;
        const auto& tiles = streamer_->update(camera, frame);
        EXPECT_TRUE(frame.warnings.empty()) << frame.warnings.front();
        auto image = renderer_->draw(camera, tiles, nullptr);
        EXPECT_TRUE(image) << image.error().text();
        EXPECT_EQ(renderer_->validation_messages(), 0u);
        return *image;
    }

    FrameImage reference(const Camera& camera) {
        if (!reference_) {
            auto reference = ReferenceRenderer::create(folder_ / "city.glb", {kWidth, kHeight, 4, {-1, 0, 0, 0}});
            EXPECT_TRUE(reference) << reference.error().text();
            reference_ = std::move(*reference);
        }
        return *reference_->draw(camera);
    }

    TemporaryFolder folder_;
    std::unique_ptr<VulkanRenderer> renderer_;
    std::unique_ptr<Fetcher> fetcher_;
    std::unique_ptr<CityStreamer> streamer_;
    std::unique_ptr<ReferenceRenderer> reference_;
};

/// The share of a rectangle that the fence's green covers before white and grey.
double green_share(const FrameImage& image, const std::array<uint32_t, 4>& box) {
    const double lit = LIGHT_AMBIENT + LIGHT_SUN * -LIGHT_SUN_Y;  // it faces south
    double sum = 0;
    for (uint32_t y = box[1]; y < box[3]; ++y) {
        for (uint32_t x = box[0]; x < box[2]; ++x) {
            const uint8_t* p = &image.rgba[4 * (size_t{y} * image.width + x)];
            sum += static_cast<double>(p[1]) - p[0];
        }
    }
    return sum / (box[2] - box[0]) / (box[3] - box[1]) / ((160.0 - 20) * lit);
}

/// The pixels of four repeats of the fence, six meshes high.
std::array<uint32_t, 4> fence_box(const Camera& camera) {
    const double pixels = camera.height / 2.0 / std::tan(camera.fov_y / 2) / (500 - camera.position[1]);
    const double left = camera.width / 2.0 + 3 * pixels, right = camera.width / 2.0 + 11 * pixels;
    const double high = camera.height / 2.0 - (1.75 - camera.position[2]) * pixels;
    const double low = camera.height / 2.0 - (0.25 - camera.position[2]) * pixels;
    return {static_cast<uint32_t>(left), static_cast<uint32_t>(high), static_cast<uint32_t>(right),
            static_cast<uint32_t>(low)};
}

uint64_t magenta(const FrameImage& image) {
    uint64_t count = 0;
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        count += image.rgba[i] > image.rgba[i + 1] + 40 && image.rgba[i + 2] > image.rgba[i + 1] + 40 ? 1 : 0;
    return count;
}

TEST_F(AlphaFlight, LooksLikeTheReferenceFromNearAndFar) {
    for (const auto& [distance, least] : {std::pair{14.0, 25.0}, {40.0, 25.0}, {120.0, 28.0}}) {
        const Camera view = camera(distance, 3);
        const FrameImage image = ours(view), wanted = reference(view);
        if (const char* keep = std::getenv("CITYSTREAM_KEEP_PICTURES")) {
            const std::string name = std::string(keep) + "/alpha_" + std::to_string(static_cast<int>(distance));
            EXPECT_TRUE(write_png(name + "_ours.png", image));
            EXPECT_TRUE(write_png(name + "_reference.png", wanted));
        }
        EXPECT_EQ(magenta(image), 0u) << "colours of what is not there show";
        EXPECT_EQ(magenta(wanted), 0u);
        EXPECT_GT(psnr(image, wanted), least) << distance;
    }
}

// Shares measured: 0.32, 0.32, 0.39, 0.39 of 0.34. Beyond 50 m the fence is a few pixels high, and two mips are blended
// before the test. With mips of a plain filter it is 0 or 1 there.
TEST_F(AlphaFlight, AFenceNeitherVanishesNorClosesHoweverFarItIs) {
    for (const double distance : {26.0, 50.0, 100.0, 200.0}) {
        const Camera view = camera(distance, 1);
        for (const double tolerance : {1.0, 4.0}) {
            const double share = green_share(ours(view, tolerance), fence_box(view));
            RecordProperty("share_" + std::to_string(static_cast<int>(distance)), std::to_string(share));
            EXPECT_NEAR(share, kFenceShare, 0.2 * kFenceShare) << distance << " m, tolerance " << tolerance;
        }
    }
}

TEST_F(AlphaFlight, PicturesThatTilesShareAndASearchMadeSmallerLookLikeTheReference) {
    const json plain = build(32), searched = build(32, {"--saliency", "rmse:0.05"});
    EXPECT_GT(searched["shared_charts"], 0);
    EXPECT_GT(searched["images"]["metric_calls"], 0);
    EXPECT_LT(searched["images"]["prepared_pixels"], plain["images"]["prepared_pixels"]);
    for (const auto& [distance, least] : {std::pair{14.0, 22.0}, {40.0, 25.0}, {120.0, 28.0}}) {
        const Camera view = camera(distance, 3);
        const FrameImage image = ours(view);
        EXPECT_EQ(magenta(image), 0u);
        EXPECT_GT(psnr(image, reference(view)), least) << distance;
    }
    for (const double distance : {26.0, 100.0}) {
        const Camera view = camera(distance, 1);
        EXPECT_NEAR(green_share(ours(view), fence_box(view)), kFenceShare, 0.2 * kFenceShare) << distance;
    }
}

TEST_F(AlphaFlight, TheArchiveSaysThatOldReadersCannotTakeIt) {
    const Outcome whole = run({program("citystream-build"), "verify", folder_ / "city.3tz"});
    EXPECT_EQ(whole.exit_code, 0) << whole.output << whole.error;
    ours(camera(14, 3));
    EXPECT_TRUE(streamer_->manifest().pages_or_alpha);
}

}  // namespace
}  // namespace citystream::tests
