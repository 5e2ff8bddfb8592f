// Flights of the real programs over a city whose atlases are in pages: the frames of the same city in charts and of the
// reference, by every transport of chart coordinates; and what the builder refuses.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "client/render/frame_file.h"
#include "client/report/image_metrics.h"
#include "tests/programs/flown_frames.h"
#include "tests/programs/program_runner.h"
#include "tests/programs/street_path.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;

constexpr const char *kLarge = "960x540", *kSmall = "320x180";
constexpr uint64_t kSeed = 7;
constexpr uint32_t kBuildings = 200;

/// The city with atlases of a form, without shared charts; the one of charts has its reference beside it.
const std::string& city(const std::string& form) {
    static const TemporaryFolder folder;
    static std::map<std::string, std::string> built;
    std::string& archive = built[form];
    if (!archive.empty()) return archive;
    archive = folder / (form + ".3tz");
    std::vector<std::string> command = {program("citystream-build"),
                                        "generate",
                                        "--buildings",
                                        std::to_string(kBuildings),
                                        "--seed",
                                        std::to_string(kSeed),
                                        "--atlas-form",
                                        form,
                                        "--shared-charts",
                                        "off",
                                        "-o",
                                        archive};
    if (form == "charts") command.insert(command.end(), {"--reference", folder / "charts.glb"});
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return archive;
}

Flown fly(const std::string& place, const std::string& size, const std::vector<std::string>& more = {}) {
    return fly_three_frames(place, path_to_street(kSeed, kBuildings, -200, 140), size, more);
}

TEST(PagesFlight, FramesAgreeWithTheReferenceAndWithThoseOfCharts) {
    const Flown charts = fly(city("charts"), kLarge), pages = fly(city("pages"), kLarge);
    std::string glb = city("charts");
    glb.replace(glb.size() - 3, 3, "glb");
    const Flown reference = fly(glb, kLarge, {"--reference", glb});
    ASSERT_EQ(reference.frames.size(), 3u);
    ASSERT_EQ(charts.frames.size(), 3u);
    ASSERT_EQ(pages.frames.size(), 3u);
    // dB. Pages 38.1, 39.0 and 38.7; charts, which have all their mips, 42.2, 44.3 and 46.4.
    constexpr std::array<double, 3> kPages = {37.5, 38.5, 38.5}, kCharts = {41.5, 43.5, 45.5};
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_GE(client::psnr(reference.frames[i], pages.frames[i]), kPages[i]) << "frame " << i;
        EXPECT_GE(client::psnr(reference.frames[i], charts.frames[i]), kCharts[i]) << "frame " << i;
        EXPECT_NE(pages.frames[i].rgba, charts.frames[i].rgba) << "frame " << i;
    }
    EXPECT_EQ(pages.summary["tiles_missing"], 0);
    EXPECT_EQ(pages.summary["charts"]["level_bytes"], 0) << "pages share nothing";
}

TEST(PagesFlight, FramesAreTheSameByEveryTransport) {
    const Flown table = fly(city("pages"), kSmall);
    ASSERT_EQ(table.frames.size(), 3u);
    for (const char* transport : {"uniform", "attribute", "packed"}) {
        const Flown other = fly(city("pages"), kSmall, {"--chart-transport", transport});
        ASSERT_EQ(other.frames.size(), 3u);
        EXPECT_EQ(other.summary["pages"]["fallback_tiles_most"], 0) << transport;
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(other.frames[i].rgba, table.frames[i].rgba) << transport << ", " << i;
    }
}

TEST(PagesFlight, PagesThatShouldShareChartsAreRefused) {
    const TemporaryFolder folder;
    const Outcome outcome = run({program("citystream-build"), "generate", "--buildings", "5", "--atlas-form", "pages",
                                 "--shared-charts", "on", "-o", folder / "city.3tz"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
    EXPECT_NE(outcome.error.find("share"), std::string::npos) << outcome.error;
    EXPECT_FALSE(std::filesystem::exists(folder / "city.3tz"));
}

}  // namespace
}  // namespace citystream::tests
