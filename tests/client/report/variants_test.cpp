#include "client/report/variants.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace citystream::client {
namespace {

VariantOptions made_by(const std::string& builder) {
    const auto folder = std::filesystem::temp_directory_path() / "citystream-variants-test";
    return {builder, {"generate", "--buildings", "10"}, folder.string(), {}};
}

TEST(Variants, TheBuilderIsCalledWithTheCityThenTheSettingThenTheOutput) {
    const VariantOptions options = made_by("builder");
    EXPECT_EQ(build_command(options, {"saliency", 0, "ssim:0.99", {}}, "a.3tz"),
              (std::vector<std::string>{"builder", "generate", "--buildings", "10", "--saliency", "ssim:0.99", "-o",
                                        "a.3tz"}));
    EXPECT_EQ(build_command(options, {"rate-distortion", 16, {}, {}}, "b.3tz")[5], "16");
    EXPECT_EQ(build_command(options, {"mesh-transport", 0, "draco", {}}, "c.3tz"),
              (std::vector<std::string>{"builder", "generate", "--buildings", "10", "--mesh-transport", "draco", "-o",
                                        "c.3tz"}));
    EXPECT_EQ(build_command(options, {"normal-bits", 24, {}, {}}, "d.3tz")[5], "24");
    EXPECT_EQ(build_command(options, {"local-directions", 4, {}, {}}, "e.3tz"),
              (std::vector<std::string>{"builder", "generate", "--buildings", "10", "--local-directions", "4", "-o",
                                        "e.3tz"}));
}

TEST(Variants, OnlySettingsThatAreBuiltGetAPlaceAndEachItsOwn) {
    std::vector<Setting> settings = {{"tolerance", 1, {}, {}},
                                     {"saliency", 0, "none", {}},
                                     {"saliency", 0, "rmse:0.05", {}},
                                     {"rate-distortion", 0, {}, {}}};
    ASSERT_TRUE(build_variants(made_by("true"), settings));
    EXPECT_TRUE(settings[0].place.empty());
    EXPECT_NE(settings[1].place, settings[2].place);
    for (size_t i = 1; i < settings.size(); ++i) EXPECT_TRUE(settings[i].place.ends_with(".3tz")) << i;
}

TEST(Variants, TheFormOfMeshesIsBuilt) {
    for (const char* knob : {"mesh-transport", "normal-bits", "mesh-topology", "precision", "mesh-steps"})
        EXPECT_TRUE(is_built(knob)) << knob;
    for (const char* knob : {"tolerance", "position-tolerance", "archive", "gpu-budget"})
        EXPECT_FALSE(is_built(knob)) << knob;
}

TEST(Variants, OfLightWhereItIsGatheredFromWhereAndHowItTravelsIsBuilt) {
    for (const char* knob : {"lattice", "directions", "local-directions", "radiance-transport"}) {
        EXPECT_TRUE(is_built(knob)) << knob;
        EXPECT_TRUE(is_of_light(knob)) << knob;
    }
    for (const char* knob : {"light-tolerance", "matrix", "matrix-error"}) {
        EXPECT_FALSE(is_built(knob)) << knob;
        EXPECT_TRUE(is_of_light(knob)) << knob;
    }
    EXPECT_FALSE(is_of_light("tolerance"));
}

TEST(Variants, ABuilderThatFailsOrIsNotThereIsAnErrorThatSaysWhatWasTried) {
    std::vector<Setting> settings = {{"saliency", 0, "none", {}}};
    const Status failed = build_variants(made_by("false"), settings);
    ASSERT_FALSE(failed);
    EXPECT_NE(failed.error().text().find("--saliency none"), std::string::npos);
    EXPECT_FALSE(build_variants(made_by("/nowhere/citystream-build"), settings));
    std::vector<Setting> others = {{"tolerance", 1, {}, {}}};
    EXPECT_TRUE(build_variants(made_by("false"), others)) << "nothing is to be built";
}

}  // namespace
}  // namespace citystream::client
