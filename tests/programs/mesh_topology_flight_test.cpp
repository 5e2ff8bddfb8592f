// A city built with each topology of its meshes: the same frames, also with little memory for decoded strip code. Of
// textures the same up to the rounding of what is interpolated (tests/client/render/mesh_topology_test.cpp).
#include <cstdlib>

#include "tests/programs/flown_frames.h"

namespace citystream::tests {
namespace {

constexpr const char* kPath =
    "t,x,y,z,yaw,pitch,fov\n0,-60,-40,60,40,-20,60\n1,20,-60,40,10,-15,60\n2,150,150,180,230,-40,60\n";

void expect_same_up_to_rounding(const Flown& flown, const Flown& wanted, const std::string& what) {
    ASSERT_EQ(flown.frames.size(), wanted.frames.size()) << what;
    for (size_t frame = 0; frame < wanted.frames.size(); ++frame) {
        const auto& a = flown.frames[frame].rgba;
        const auto& b = wanted.frames[frame].rgba;
        ASSERT_EQ(a.size(), b.size());
        size_t differing = 0;
        for (size_t i = 0; i < a.size(); ++i) {
            ASSERT_LE(std::abs(a[i] - b[i]), 1) << what << ", frame " << frame;
            differing += a[i] != b[i] ? 1 : 0;
        }
        EXPECT_LE(differing, a.size() / 50000) << what << ", frame " << frame;
    }
}

TEST(MeshTopologyFlight, FramesAreTheSameWhateverTheTopology) {
    const TemporaryFolder folder;
    const auto fly = [&](const std::string& topology, const std::vector<std::string>& more) {
        const std::string city = folder / (topology + ".3tz");
        if (!std::filesystem::exists(city)) {
            const Outcome built = run({program("citystream-build"), "generate", "--buildings", "60", "--seed", "3",
                                       "--mesh-topology", topology, "-o", city});
            EXPECT_EQ(built.exit_code, 0) << built.error;
        }
        return fly_three_frames(city, kPath, "320x180", more);
    };
    const Flown indices = fly("indices", {});
    ASSERT_EQ(indices.frames.size(), 3u);
    EXPECT_NE(indices.frames[0].rgba, indices.frames[1].rgba);
    expect_same_up_to_rounding(fly("local-strips", {}), indices, "local strips");
    const Flown strip_code = fly("strip-code", {});
    expect_same_up_to_rounding(strip_code, indices, "strip code");
    const Flown in_rounds = fly("strip-code", {"--index-arena", "64KiB"});
    ASSERT_EQ(in_rounds.frames.size(), strip_code.frames.size());
    for (size_t i = 0; i < in_rounds.frames.size(); ++i)
        EXPECT_EQ(in_rounds.frames[i].rgba, strip_code.frames[i].rgba) << "in rounds, frame " << i;
}

TEST(MeshTopologyFlight, AnArenaOfNoSizeIsWrongUsage) {
    const Outcome flown = run({program("citystream-fly"), "city.3tz", "--path", "path.csv", "--index-arena", "large"});
    EXPECT_EQ(flown.exit_code, 2);
    EXPECT_NE(flown.error.find("--index-arena"), std::string::npos) << flown.error;
}

}  // namespace
}  // namespace citystream::tests
