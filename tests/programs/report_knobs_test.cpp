// citystream-report with the knobs that build the city, as a user turns them.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;
using Command = std::vector<std::string>;

const Command kCity = {"generate", "--buildings", "12", "--seed", "7"};

Command joined(Command a, const Command& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// A city with its reference and a path over it.
struct Workplace {
    Workplace() {
        write_file(folder / "path.csv", "t,x,y,z,yaw,pitch,fov\n0,-60,-60,160,45,-60,60\n1,-20,-40,120,45,-60,60\n");
        const Outcome built = run(joined(joined({program("citystream-build")}, kCity),
                                         {"-o", folder / "c.3tz", "--reference", folder / "c.glb"}));
        EXPECT_EQ(built.exit_code, 0) << built.error;
    }
    Outcome report(const Command& knobs) const {
        return run(joined({program("citystream-report"), folder / "c.3tz", "--path", folder / "path.csv", "-o",
                           folder / "report", "--size", "320x180", "--frames", "2"},
                          knobs));
    }
    TemporaryFolder folder;
};

const Workplace& workplace() {
    static const Workplace place;
    return place;
}

TEST(ReportKnobs, CitiesAreBuiltAndFlownOncePerSaliencyAndRateDistortion) {
    const Workplace& place = workplace();
    const Outcome made = place.report(joined(
        {"--json", "--texel-tolerances", "1,64", "--saliencies", "none,flip:0.2", "--rate-distortions", "256", "--"},
        kCity));
    ASSERT_EQ(made.exit_code, 0) << made.error;
    std::map<std::string, Json> settings;
    const Json report = Json::parse(made.output);
    for (const Json& setting : report["settings"]) {
        const Json& value = setting["value"];
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        settings[setting["knob"].get<std::string>() + " " + text] = setting;
    }
    ASSERT_EQ(settings.size(), 5u);
    EXPECT_EQ(settings["saliency none"]["wire_bytes"], settings["texel-tolerance 1.0"]["wire_bytes"])
        << "the same city";
    EXPECT_EQ(settings["saliency none"]["psnr_db_median"], settings["texel-tolerance 1.0"]["psnr_db_median"]);
    EXPECT_LT(settings["texel-tolerance 64.0"]["atlas_bytes"], settings["texel-tolerance 1.0"]["atlas_bytes"]);
    EXPECT_LT(settings["rate-distortion 256.0"]["atlas_bytes"], settings["saliency none"]["atlas_bytes"]);
    EXPECT_LT(settings["rate-distortion 256.0"]["ssim_median"], settings["saliency none"]["ssim_median"]);
    EXPECT_NE(settings["saliency flip:0.2"]["build_options"].get<std::string>().find("saliency=flip:0.2"),
              std::string::npos);
    const std::string page = read_file(place.folder / "report/index.html");
    for (const char* file : {"saliency_flip_0.2_001.png", "rate-distortion_256_000_flip.png"}) {
        EXPECT_NE(page.find(file), std::string::npos) << file;
        EXPECT_TRUE(std::filesystem::exists(place.folder / ("report/pictures/" + std::string(file)))) << file;
    }
    EXPECT_TRUE(std::filesystem::exists(place.folder / "report/error-picture-bytes.svg"));
}

/// One line on stderr that has the text.
void expect_complaint(const Outcome& outcome, const std::string& text) {
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.error.find(text), std::string::npos) << outcome.error;
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
}

TEST(ReportKnobs, WhatCannotBeBuiltIsOneClearLine) {
    const Workplace& place = workplace();
    expect_complaint(place.report({"--rate-distortions", "4"}), "behind --");
    expect_complaint(place.report({"--precisions", "ap,cap"}), "behind --");
    expect_complaint(place.report(joined({"--saliencies", "beauty:0.5", "--"}, kCity)), "--saliencies beauty:0.5");
    const Outcome failed = place.report({"--saliencies", "none", "--", "nowhere.city.json"});
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_NE(failed.error.find("nowhere.city.json"), std::string::npos) << failed.error;
}

}  // namespace
}  // namespace citystream::tests
