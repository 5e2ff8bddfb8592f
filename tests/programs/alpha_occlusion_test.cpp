// What is cut out hides nothing: behind a wall of wire everything is fetched and drawn that is without occlusion,
// behind the same wall without holes it is not.

#include <gtest/gtest.h>

#include "client/render/vulkan_renderer.h"
#include "client/stream/city_streamer.h"
#include "tests/programs/block_city.h"
#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using namespace client;

/// An uncompressed TGA file of 16 x 16 texels: a wire mesh, with or without holes between the wires.
std::string wires(bool holes) {
    std::string file(18, '\0');
    file[2] = 2;
    file[12] = file[14] = 16;
    file[16] = 32;
    file[17] = 8;
    for (int i = 0; i < 256; ++i)
        file += std::string("\x30\x40\x50", 3) + (holes && i % 16 > 3 && i / 16 > 3 ? '\0' : '\xff');
    return file;
}

struct Seen {
    FrameImage image;
    uint64_t hidden = 0, drawn = 0;
};

class AlphaOcclusion : public testing::Test {
  protected:
    void build(bool holes) {
        write_file(folder_ / "noise.tga", noise_texture());
        write_file(folder_ / "wall.tga", wires(holes));
        write_file(folder_ / "city.json", block_city(true));
        const Outcome built = run({program("citystream-build"), folder_ / "city.json", "-o", folder_ / "city.3tz",
                                   "--texture-law", "0.02,8,4", "--shared-charts", "off", "--json"});
        ASSERT_EQ(built.exit_code, 0) << built.error;
    }

    Seen look(bool occlusion) {
        RendererOptions options;
        options.width = 640;
        options.height = 360;
        auto renderer = std::move(*VulkanRenderer::create(options));
        auto fetcher = std::move(*Fetcher::open(folder_ / "city.3tz", FetcherOptions{}));
        StreamerOptions streaming;
        streaming.occlusion = occlusion;
        auto streamer = std::move(*CityStreamer::open(*fetcher, *renderer, streaming));
        CameraSample sample;
        sample.x = 500 + kBlocks / 2 * kBlockPitch;
        sample.y = 485;
        sample.z = 30;
        sample.fov = 60;
        const Camera camera = Camera::from_sample(sample, options.width, options.height);
        StreamerFrame frame;
        const auto& draws = streamer->update(camera, frame);
        auto image = renderer->draw(camera, draws, nullptr);
        EXPECT_TRUE(image.ok());
        return {std::move(*image), frame.tiles_hidden, frame.tiles_drawn};
    }

    TemporaryFolder folder_;
};

TEST_F(AlphaOcclusion, AWallOfWireHidesLessThanASolidOneAndNothingThatShows) {
    build(true);
    const Seen wire = look(true), all_of_wire = look(false);
    EXPECT_EQ(wire.image.rgba, all_of_wire.image.rgba);
    build(false);
    const Seen solid = look(true), all_of_solid = look(false);
    EXPECT_EQ(solid.image.rgba, all_of_solid.image.rgba);
    EXPECT_LT(wire.hidden, solid.hidden) << "blocks hide some tiles through the wire";
    EXPECT_GT(wire.drawn, solid.drawn);
}

}  // namespace
}  // namespace citystream::tests
