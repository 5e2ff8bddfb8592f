// A city without pictures, from file to frames: no atlas is stored or moved, and its colours are the reference's.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/report/image_metrics.h"
#include "tests/programs/block_city.h"
#include "tests/programs/flown_frames.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

constexpr const char* kPath =
    "t,x,y,z,yaw,pitch,fov\n0,450,450,150,40,-15,60\n1,900,1900,3,100,5,60\n2,2000,2000,900,0,-70,60\n";
constexpr const char* kSize = "480x270";

/// The blocks without their textures, walls and roofs told apart.
std::string plain_city() {
    json city = json::parse(block_city());
    city.erase("appearance");
    for (json& object : city["CityObjects"]) {
        json& geometry = object["geometry"][0];
        geometry.erase("texture");
        geometry["semantics"] = {{"surfaces", {{{"type", "WallSurface"}}, {{"type", "RoofSurface"}}}},
                                 {"values", {0, 0, 0, 0, 1}}};
    }
    return city.dump();
}

TEST(PlainCityFlight, MovesNoAtlasAndAgreesWithTheReference) {
    const TemporaryFolder folder;
    write_file(folder / "plain.city.json", plain_city());
    const std::string glb = folder / "plain.glb";
    const Flown reference = [&] {
        const Outcome built = run(
            {program("citystream-build"), folder / "plain.city.json", "-o", folder / "charts.3tz", "--reference", glb});
        EXPECT_EQ(built.exit_code, 0) << built.error;
        return fly_three_frames(glb, kPath, kSize, {"--reference", glb});
    }();
    const Outcome paged = run(
        {program("citystream-build"), folder / "plain.city.json", "--atlas-form", "pages", "-o", folder / "pages.3tz"});
    ASSERT_EQ(paged.exit_code, 0) << paged.error;
    ASSERT_EQ(reference.frames.size(), 3U);
    for (const char* form : {"charts.3tz", "pages.3tz"}) {
        const Outcome info = run({program("citystream-build"), "info", folder / form, "--json"});
        ASSERT_EQ(info.exit_code, 0) << info.error;
        EXPECT_EQ(json::parse(info.output)["layers"]["atlas"]["wire_bytes"], 0) << form;
        const Flown flown = fly_three_frames(folder / form, kPath, kSize, {});
        ASSERT_EQ(flown.frames.size(), 3U);
        EXPECT_EQ(flown.summary["bytes"]["layers"]["atlas"], 0) << form;
        EXPECT_GT(flown.summary["bytes"]["layers"]["mesh"], 0) << form;
        for (size_t i = 0; i < 3; ++i)
            EXPECT_GE(client::psnr(reference.frames[i], flown.frames[i]), 40) << form << ", frame " << i;
    }
}

}  // namespace
}  // namespace citystream::tests
