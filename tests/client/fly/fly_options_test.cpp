#include "client/fly/fly_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace citystream::client {
namespace {

/// What a command line is read as; an error of either reader.
Result<FlyOptions> read(const std::vector<std::string>& words) {
    CLI::App app{"A flight."};
    FlyArguments arguments;
    add_fly_options(app, arguments);
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    try {
        app.parse(reversed);
    } catch (const CLI::ParseError& error) {
        return Error{error.what()};
    }
    return read_fly_options(arguments);
}

Result<FlyOptions> read_flight(std::vector<std::string> more) {
    more.insert(more.begin(), {"city.3tz", "--path", "tour.csv"});
    return read(more);
}

TEST(FlyOptions, OfACityAloneAreTheUsualOnes) {
    const auto options = read_flight({});
    ASSERT_TRUE(options) << options.error().text();
    const RendererOptions renderer = renderer_options(*options), usual;
    EXPECT_EQ(renderer.width, usual.width);
    EXPECT_EQ(renderer.height, usual.height);
    EXPECT_EQ(renderer.gpu_budget_bytes, usual.gpu_budget_bytes);
    EXPECT_EQ(renderer.index_arena_bytes, usual.index_arena_bytes);
    EXPECT_EQ(renderer.btf_budget_bytes, usual.btf_budget_bytes);
    EXPECT_FALSE(renderer.meso);
    const StreamerOptions streamer = streamer_options(*options);
    EXPECT_EQ(streamer.tolerance_pixels, 1);
    EXPECT_FALSE(streamer.light_tolerance) << "no light is fetched";
    EXPECT_TRUE(streamer.wait_for_selection);
}

TEST(FlyOptions, OfLightReachWhoDrawsAndWhoStreams) {
    const auto options = read_flight({"--environment", "sky", "--light-tolerance", "0.1", "--matrix", "rows",
                                      "--matrix-error", "0.02", "--meso", "on", "--btf-budget", "1MiB", "--btf-texels",
                                      "32", "--size", "64x32", "--mode", "realtime"});
    ASSERT_TRUE(options) << options.error().text();
    const StreamerOptions streamer = streamer_options(*options);
    EXPECT_EQ(streamer.light_tolerance, 0.1);
    EXPECT_EQ(streamer.matrix_form, codec::radiance::MatrixForm::kRows);
    EXPECT_EQ(streamer.matrix_error, 0.02);
    EXPECT_FALSE(streamer.wait_for_selection);
    const RendererOptions renderer = renderer_options(*options);
    EXPECT_TRUE(renderer.meso);
    EXPECT_EQ(renderer.btf_budget_bytes, 1U << 20);
    EXPECT_EQ(renderer.btf_texels, 32U);
    EXPECT_EQ(renderer.width, 64U);
    const auto plain = read_flight({"--environment", "sky"});
    ASSERT_TRUE(plain);
    EXPECT_EQ(streamer_options(*plain).light_tolerance, kUsualLightTolerance);
}

TEST(FlyOptions, ThatDoNotGoTogetherOrAreNoValuesAreNamed) {
    struct Case {
        std::vector<std::string> words;
        std::string named;
    };
    const std::vector<Case> cases = {
        {{"--environment", ""}, "--environment"},
        {{"--environment-path", ""}, "--environment-path"},
        {{"--meso", "on"}, "--meso needs --environment"},
        {{"--btf-budget", "1MiB"}, "--btf-budget needs --environment"},
        {{"--btf-texels", "32"}, "--btf-texels needs --environment"},
        {{"--environment", "sky", "--btf-texels", "32"}, "--btf-texels needs --meso on"},
        {{"--light-tolerance", "0.1"}, "--light-tolerance needs --environment"},
        {{"--matrix", "rows"}, "--matrix needs --environment"},
        {{"--matrix-error", "0.1"}, "--matrix-error needs --environment"},
        {{"--environment", "sky", "--btf-budget", "1MiB"}, "--btf-budget needs --meso on"},
        {{"--environment", "sky", "--meso", "off", "--btf-budget", "1MiB"}, "--btf-budget needs --meso on"},
        {{"--environment", "sky", "--meso", "on", "--btf-budget", "some"}, "--btf-budget"},
        {{"--environment", "sky", "--reference", "city.glb"}, "--reference"},
        {{"--environment", "sky", "--exposure", "bright"}, "--exposure"},
        {{"--network", "fast"}, "--network"},
        {{"--gpu-budget", "much"}, "--gpu-budget"},
        {{"--size", "0x10"}, "--size"},
        {{"--facade-tint", "red"}, "--facade-tint"}};
    for (const Case& one : cases) {
        const auto options = read_flight(one.words);
        ASSERT_FALSE(options) << one.named;
        EXPECT_NE(options.error().text().find(one.named), std::string::npos) << options.error().text();
        EXPECT_EQ(options.error().text().find('\n'), std::string::npos) << options.error().text();
    }
    EXPECT_NE(read({"city.3tz"}).error().text().find("--path"), std::string::npos);
    EXPECT_FALSE(read({"--path", "tour.csv"}));
}

}  // namespace
}  // namespace citystream::client
