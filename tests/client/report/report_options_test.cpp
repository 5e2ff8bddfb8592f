#include "client/report/report_options.h"

#include <gtest/gtest.h>

#include "client/report/lit_reference.h"

namespace citystream::client {
namespace {

/// What a command line is read as; an error of either reader.
Result<ReportPlan> read(std::vector<std::string> more) {
    CLI::App app{"A report."};
    ReportArguments arguments;
    add_report_options(app, arguments);
    more.insert(more.begin(), {"city.3tz", "--path", "tour.csv", "-o", "report"});
    std::vector<std::string> reversed(more.rbegin(), more.rend());
    try {
        app.parse(reversed);
    } catch (const CLI::ParseError& error) {
        return Error{error.what()};
    }
    return read_report_options(arguments);
}

TEST(ReportOptions, WithoutKnobsToleranceIsTurned) {
    const auto plan = read({});
    ASSERT_TRUE(plan) << plan.error().text();
    ASSERT_EQ(plan->settings.size(), 6U);
    for (const Setting& setting : plan->settings) EXPECT_EQ(setting.knob, "tolerance");
    const SweepOptions usual;
    EXPECT_EQ(plan->sweep.city, "city.3tz");
    EXPECT_EQ(plan->sweep.width, usual.width);
    EXPECT_EQ(plan->sweep.frames, usual.frames);
    EXPECT_EQ(plan->sweep.tolerance_pixels, usual.tolerance_pixels);
    EXPECT_EQ(plan->sweep.facade_renderer, usual.facade_renderer);
}

TEST(ReportOptions, KnobsAreTurnedOneByOneAndTheOthersStandWhereTheyArePut) {
    const auto plan = read({"--facade-renderers", "patch,fdm", "--texel-tolerances", "2", "--also", "b=b.3tz",
                            "--tolerance", "3", "--relief-tolerance", "4", "--size", "64x32", "--frames", "2"});
    ASSERT_TRUE(plan) << plan.error().text();
    std::vector<std::string> labels;
    for (const Setting& setting : plan->settings) labels.push_back(setting.knob + " " + setting.label());
    EXPECT_EQ(labels, (std::vector<std::string>{"texel-tolerance 2 px", "facade-renderer patch", "facade-renderer fdm",
                                                "archive as given", "archive b"}));
    EXPECT_EQ(plan->sweep.tolerance_pixels, 3);
    EXPECT_EQ(plan->sweep.relief.tolerance_pixels, 4);
    EXPECT_EQ(plan->sweep.height, 32U);
    EXPECT_EQ(plan->sweep.frames, 2U);
}

TEST(ReportOptions, OfLightReachTheSweep) {
    if (!lit_references_can_be_drawn()) GTEST_SKIP() << "there is no Embree";
    const auto plan = read({"--environment", "sky", "--hour", "18", "--matrix", "rows", "--matrix-error", "0.02",
                            "--light-tolerance", "0.1", "--reference-rays", "64", "--light-tolerances", "0,0.2"});
    ASSERT_TRUE(plan) << plan.error().text();
    EXPECT_EQ(plan->settings.size(), 2U);
    EXPECT_EQ(plan->sweep.matrix, codec::radiance::MatrixForm::kRows);
    EXPECT_EQ(plan->sweep.matrix_error, 0.02);
    EXPECT_EQ(plan->sweep.light_tolerance, 0.1);
    EXPECT_EQ(plan->sweep.reference_rays, 64U);
    EXPECT_NE(plan->sweep.environment.find("18 h"), std::string::npos);
}

TEST(ReportOptions, ThatDoNotGoTogetherAreNamed) {
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
        {{"--lattices", "4"}, "--lattices needs --environment"},
        {{"--matrices", "rows"}, "--matrices needs --environment"},
        {{"--matrix", "rows"}, "--matrix needs --environment"},
        {{"--reference-rays", "9"}, "--reference-rays needs --environment"},
        {{"--normal-bits", "16"}, "behind --"},
        {{"--saliencies", "ssim:x"}, "--saliencies"},
        {{"--also", "a=a.3tz", "--also", "a=b.3tz"}, "the name is taken"},
        {{"--size", "9000x9000"}, "--size"}};
    for (const auto& [words, named] : cases) {
        const auto plan = read(words);
        ASSERT_FALSE(plan) << named;
        EXPECT_NE(plan.error().text().find(named), std::string::npos) << plan.error().text();
    }
}

}  // namespace
}  // namespace citystream::client
