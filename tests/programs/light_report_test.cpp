// citystream-report of a city under a sky, as a user makes it: the knobs of light, and a ray traced reference that lit
// frames are near to.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "client/report/lit_reference.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;
using Command = std::vector<std::string>;

const Command kCity = {
    "generate", "--buildings", "8", "--seed", "7", "--layers", "mesh,facade,atlas,radiance", "--directions", "8"};

Command joined(Command a, const Command& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

class LightReport : public testing::Test {
  protected:
    void SetUp() override {
        if (!client::lit_references_can_be_drawn()) GTEST_SKIP() << "there is no Embree";
        write_file(folder_ / "path.csv", "t,x,y,z,yaw,pitch,fov\n0,-40,-40,40,45,-25,60\n1,20,-30,25,20,-25,60\n");
    }
    void build(const Command& city, const std::string& name) const {
        const Outcome built = run(joined(joined({program("citystream-build")}, city),
                                         {"-o", folder_ / (name + ".3tz"), "--reference", folder_ / (name + ".glb")}));
        ASSERT_EQ(built.exit_code, 0) << built.error;
    }
    Outcome report(const std::string& name, const Command& more) const {
        return run(
            joined({program("citystream-report"), folder_ / (name + ".3tz"), "--path", folder_ / "path.csv", "-o",
                    folder_ / "report", "--size", "96x54", "--frames", "2", "--reference-rays", "64", "--json"},
                   more));
    }
    static std::map<std::string, Json> settings_of(const Json& report) {
        std::map<std::string, Json> settings;
        for (const Json& setting : report["settings"]) {
            const Json& value = setting["value"];
            const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
            settings[setting["knob"].get<std::string>() + " " + text] = setting;
        }
        return settings;
    }
    TemporaryFolder folder_;
};

TEST_F(LightReport, EveryKnobOfLightIsFlownAgainstRaysUnderTheSameSky) {
    const Command city = joined(kCity, {"--lattice", "8"});
    build(city, "c");
    const Outcome made =
        report("c", joined({"--environment", "sky", "--hour", "15", "--light-tolerances", "0,1", "--matrices", "rows",
                            "--matrix-errors", "0.1", "--lattices", "16,4", "--"},
                           kCity));
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const Json report = Json::parse(made.output);
    auto settings = settings_of(report);
    ASSERT_EQ(settings.size(), 6u);
    EXPECT_EQ(report["light"]["rays_a_pixel"], 64);
    for (auto& [name, setting] : settings) {
        EXPECT_GT(setting["psnr_db_median"], 24.0) << name;
        EXPECT_GT(setting["light"]["light_ms_median"], 0.0) << name;
        EXPECT_GT(setting["light"]["receivers_most"], 0) << name;
        EXPECT_GT(setting["light"]["radiance_bytes"], 0) << name;
    }
    const Json &all = settings["light-tolerance 0.0"], &first = settings["light-tolerance 1.0"];
    EXPECT_LT(first["light"]["radiance_bytes"], all["light"]["radiance_bytes"]);
    EXPECT_EQ(first["light"]["receivers_most"], all["light"]["receivers_most"]);
    EXPECT_GT(settings["matrix rows"]["light"]["radiance_gpu_bytes_most"], 0);
    EXPECT_GT(settings["matrix-error 0.1"]["light"]["row_error_most"], 0.0);
    EXPECT_LE(settings["matrix-error 0.1"]["light"]["row_error_most"], 0.1);
    EXPECT_EQ(all["light"]["row_error_most"], 0.0);
    EXPECT_LT(settings["lattice 16.0"]["light"]["archive"]["receivers"],
              settings["lattice 4.0"]["light"]["archive"]["receivers"]);
    const std::string page = read_file(folder_ / "report/index.html");
    for (const char* text : {"lattice_16_001.png", "matrix_rows_000_flip.png", "What radiance costs", "lattice 16 m: "})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    for (const char* file : {"report/psnr-radiance-bytes.svg", "report/psnr-light-time.svg",
                             "report/pictures/reference_001.png", "report/archives/lattice_4.3tz"})
        EXPECT_TRUE(std::filesystem::exists(folder_ / file)) << file;
}

TEST_F(LightReport, ACityWithoutTheLayerIsReportedAsOne) {
    build({"generate", "--buildings", "4", "--seed", "7"}, "dark");
    const Outcome made = report("dark", {"--environment", "sky", "--tolerances", "1"});
    ASSERT_EQ(made.exit_code, 0) << made.error;
    const Json report = Json::parse(made.output);
    const Json& setting = report["settings"][0];
    EXPECT_EQ(setting["light"]["radiance_bytes"], 0);
    EXPECT_EQ(setting["light"]["receivers_most"], 0);
    ASSERT_EQ(setting["warnings"].size(), 1u);
    EXPECT_NE(setting["warnings"][0].get<std::string>().find("no radiance layer"), std::string::npos);
    EXPECT_NE(read_file(folder_ / "report/index.html").find("The city has no radiance layer"), std::string::npos);
}

TEST_F(LightReport, AnEnvironmentThatCannotBeReadIsOneClearLineBeforeAnyWork) {
    write_file(folder_ / "c.glb", "unread");
    const Outcome failed = report("c", {"--environment", "/nowhere/dawn.exr"});
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_NE(failed.error.find("/nowhere/dawn.exr"), std::string::npos) << failed.error;
    EXPECT_EQ(std::count(failed.error.begin(), failed.error.end(), '\n'), 1) << failed.error;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "report"));
}

}  // namespace
}  // namespace citystream::tests
