// A city whose meshes travel in libdraco's form: the same frames.
#include <algorithm>

#include "client/report/image_metrics.h"
#include "tests/programs/flown_frames.h"

namespace citystream::tests {
namespace {

constexpr const char* kPath =
    "t,x,y,z,yaw,pitch,fov\n0,-60,-40,60,40,-20,60\n1,20,-60,40,10,-15,60\n2,150,150,180,230,-40,60\n";

TEST(MeshTransportFlight, FramesAreTheSameWhicheverWayMeshesTravel) {
    const TemporaryFolder folder;
    const auto fly = [&](const std::string& name, const std::vector<std::string>& form) {
        const std::string city = folder / (name + ".3tz");
        std::vector<std::string> command = {
            program("citystream-build"), "generate", "--buildings", "60", "--seed", "3", "-o", city};
        command.insert(command.end(), form.begin(), form.end());
        const Outcome built = run(command);
        EXPECT_EQ(built.exit_code, 0) << built.error;
        return fly_three_frames(city, kPath, "320x180", {});
    };
    const Flown wanted = fly("default", {"--mesh-steps", "1"});
    ASSERT_EQ(wanted.frames.size(), 3u);
    const Flown draco = fly("draco", {"--mesh-transport", "draco"});
    ASSERT_EQ(draco.frames.size(), 3u);
    for (size_t frame = 0; frame < 3; ++frame) {
        const auto& a = draco.frames[frame].rgba;
        const auto& b = wanted.frames[frame].rgba;
        ASSERT_EQ(a.size(), b.size());
        // libdraco turns triangles and draws them in another order: what is interpolated over them is rounded
        // otherwise, and of two surfaces that meet in a pixel the other one may be in front.
        size_t differing = 0;
        for (size_t pixel = 0; pixel < a.size(); pixel += 4)
            differing += std::equal(&a[pixel], &a[pixel] + 4, &b[pixel]) ? 0 : 1;
        EXPECT_LE(differing, a.size() / 4 / 10000) << "frame " << frame;
        EXPECT_GE(client::psnr(draco.frames[frame], wanted.frames[frame]), 55) << "frame " << frame;
    }
}

}  // namespace
}  // namespace citystream::tests
