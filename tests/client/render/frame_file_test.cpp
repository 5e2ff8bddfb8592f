#include "client/render/frame_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "client/render/video_writer.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

class FrameFile : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        folder_ = std::filesystem::temp_directory_path() / ("citystream_frames_" + name + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    static std::string bytes_of(const std::string& file) {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    std::filesystem::path folder_;
};

FrameImage noise(uint32_t width, uint32_t height, uint64_t seed) {
    Random random{seed};
    FrameImage image{width, height, std::vector<uint8_t>(size_t{4} * width * height)};
    for (size_t i = 0; i < image.rgba.size(); ++i)
        image.rgba[i] = i % 4 == 3 ? 255 : static_cast<uint8_t>(random.next());
    return image;
}

TEST_F(FrameFile, PngComesBackAsItWasAndTwiceTheSame) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {17u, 5u}, {320u, 240u}}) {
        const FrameImage image = noise(width, height, width);
        ASSERT_TRUE(write_png(path("a.png"), image).ok());
        ASSERT_TRUE(write_png(path("b.png"), image).ok());
        EXPECT_EQ(bytes_of(path("a.png")), bytes_of(path("b.png")));
        const Result<FrameImage> back = read_png(path("a.png"));
        ASSERT_TRUE(back.ok()) << back.error().text();
        EXPECT_EQ(back->width, width);
        EXPECT_EQ(back->height, height);
        EXPECT_EQ(back->rgba, image.rgba);
    }
}

TEST_F(FrameFile, BadFilesAndPlacesAreErrorsThatNameThem) {
    const Status nowhere = write_png(path("none/a.png"), noise(4, 4, 1));
    ASSERT_FALSE(nowhere.ok());
    EXPECT_NE(nowhere.error().message.find("none/a.png"), std::string::npos);
    EXPECT_FALSE(write_png(path("a.png"), FrameImage{}).ok());
    EXPECT_FALSE(read_png(path("missing.png")).ok());
    std::ofstream(path("text.png")) << "not a picture";
    EXPECT_FALSE(read_png(path("text.png")).ok());
    ASSERT_TRUE(write_png(path("whole.png"), noise(64, 64, 3)).ok());
    const std::string whole = bytes_of(path("whole.png"));
    std::ofstream(path("cut.png"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    EXPECT_FALSE(read_png(path("cut.png")).ok());
}

TEST_F(FrameFile, FilmsOfTheSameFramesAreTheSameBytes) {
    for (const char* name : {"a.mp4", "b.mp4"}) {
        auto film = VideoWriter::create(path(name), {65, 48, 25, 20});
        ASSERT_TRUE(film.ok()) << film.error().text();
        for (uint64_t i = 0; i < 12; ++i) ASSERT_TRUE((*film)->add(noise(65, 48, i)).ok());
        EXPECT_FALSE((*film)->add(noise(64, 48, 1)).ok());
        ASSERT_TRUE((*film)->finish().ok());
    }
    const std::string film = bytes_of(path("a.mp4"));
    EXPECT_EQ(film, bytes_of(path("b.mp4")));
    EXPECT_EQ(film.substr(4, 4), "ftyp");
    EXPECT_NE(film.find("avc1"), std::string::npos);
    EXPECT_FALSE(VideoWriter::create(path("none/a.mp4"), {64, 48, 25, 20}).ok());
    EXPECT_FALSE(VideoWriter::create(path("c.mp4"), {0, 48, 25, 20}).ok());
}

}  // namespace
}  // namespace citystream::client::test
