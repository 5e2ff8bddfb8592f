// A city whose light travels in every way that there is: the same frames.
#include "tests/programs/flown_frames.h"
#include "tiles/layers/radiance_form.h"

namespace citystream::tests {
namespace {

using codec::radiance::kRadianceTransportNames;

constexpr const char* kPath =
    "t,x,y,z,yaw,pitch,fov\n0,-40,-40,40,45,-25,60\n1,-30,-40,40,40,-20,60\n2,60,-50,70,0,-40,60\n";

/// A few houses, baked coarsely.
std::string build(const TemporaryFolder& folder, std::string_view transport) {
    std::string city = folder / (std::string(transport) + ".3tz");
    const Outcome built = run({program("citystream-build"), "generate", "--buildings", "8", "--seed", "1", "--layers",
                               "mesh,facade,atlas,radiance", "--lattice", "8", "--directions", "8",
                               "--radiance-transport", std::string(transport), "-o", city, "--json"});
    EXPECT_EQ(built.exit_code, 0) << built.error;
    return city;
}

nlohmann::json info_of(const std::string& city) {
    const Outcome outcome = run({program("citystream-build"), "info", city, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return nlohmann::json::parse(outcome.output);
}

Flown fly(const std::string& city, const std::vector<std::string>& more) {
    std::vector<std::string> light = {"--environment", "sky", "--hour", "9", "--light-tolerance", "0"};
    light.insert(light.end(), more.begin(), more.end());
    return fly_three_frames(city, kPath, "160x90", light);
}

TEST(RadianceTransportFlight, FramesAreTheSameWhicheverWayLightTravels) {
    if (!tiles::layers::radiance_can_be_built()) GTEST_SKIP() << "there is no Embree";
    const TemporaryFolder folder;
    Flown wanted;
    for (const std::string_view transport : kRadianceTransportNames) {
        const std::string city = build(folder, transport);
        const nlohmann::json radiance = info_of(city)["radiance"];
        EXPECT_EQ(radiance["transports"], (nlohmann::json{{transport, radiance["tiles"]}}));
        EXPECT_EQ(radiance["prefixes"].size(), transport == kRadianceTransportNames[0] ? 3u : 1u);
        const Flown flown = fly(city, {});
        ASSERT_EQ(flown.frames.size(), 3u);
        EXPECT_EQ(flown.summary["bytes"]["layers"]["radiance"].get<uint64_t>() > 0, true);
        if (transport == kRadianceTransportNames[0]) wanted = flown;
        for (size_t frame = 0; frame < 3; ++frame)
            EXPECT_EQ(flown.frames[frame].rgba, wanted.frames[frame].rgba) << transport << " frame " << frame;
    }
    // Light makes a difference, and so does what is left out of the matrix.
    const std::string clusters = folder / "biclusters.3tz";
    EXPECT_NE(fly(clusters, {"--environment-rotation", "90"}).frames[0].rgba, wanted.frames[0].rgba);
    const Flown lossy = fly(clusters, {"--matrix-error", "0.3"});
    EXPECT_NE(lossy.frames[0].rgba, wanted.frames[0].rgba);
    EXPECT_EQ(lossy.frames[0].rgba, fly(folder / "rows.3tz", {"--matrix-error", "0.3"}).frames[0].rgba);
    EXPECT_EQ(fly(clusters, {"--matrix", "rows"}).frames[0].rgba, wanted.frames[0].rgba);
}

TEST(RadianceTransportFlight, AnUnknownTransportOrOneOfNoLightIsWrongUsage) {
    const auto refuse = [](const std::string& layers, const std::string& transport) {
        const Outcome built = run({program("citystream-build"), "generate", "--buildings", "1", "--layers", layers,
                                   "--radiance-transport", transport, "-o", "/nowhere/city.3tz"});
        EXPECT_EQ(built.exit_code, 2);
        EXPECT_NE(built.error.find("--radiance-transport"), std::string::npos) << built.error;
    };
    refuse("mesh,radiance", "carrier-pigeon");
    refuse("mesh", "biclusters");
}

}  // namespace
}  // namespace citystream::tests
