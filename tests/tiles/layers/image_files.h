// Image files for tests, written by OpenImageIO or byte by byte.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace citystream::tiles::layers {

/// A folder of its own that goes away with the test.
class ImageFolder {
  public:
    ImageFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "citystream-images-XXXXXX").string();
        EXPECT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    ~ImageFolder() { std::filesystem::remove_all(folder_); }
    ImageFolder(const ImageFolder&) = delete;
    ImageFolder& operator=(const ImageFolder&) = delete;
    std::string path(const std::string& name = {}) const { return (folder_ / name).string(); }

    /// Values row by row from the top; returns the path.
    template <typename T>
    std::string write(const std::string& name, OIIO::ImageSpec spec, const std::vector<T>& values,
                      OIIO::TypeDesc type) const {
        auto output = OIIO::ImageOutput::create(path(name));
        EXPECT_TRUE(output) << name;
        if (!output) return path(name);
        EXPECT_TRUE(output->open(path(name), spec)) << output->geterror();
        EXPECT_TRUE(output->write_image(type, values.data())) << output->geterror();
        EXPECT_TRUE(output->close()) << output->geterror();
        return path(name);
    }
    std::string write(const std::string& name, int width, int height, int channels,
                      const std::vector<uint8_t>& values) const {
        return write(name, OIIO::ImageSpec(width, height, channels, OIIO::TypeDesc::UINT8), values,
                     OIIO::TypeDesc::UINT8);
    }
    std::string write_bytes(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }
    std::string bytes_of(const std::string& name) const {
        std::ifstream file(path(name), std::ios::binary);
        return {(std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()};
    }

  private:
    std::filesystem::path folder_;
};

/// Bytes that look like noise, the same at every call.
inline std::vector<uint8_t> noise(size_t count, uint32_t seed = 1) {
    std::vector<uint8_t> values(count);
    for (uint8_t& value : values) {
        seed = seed * 1664525U + 1013904223U;
        value = static_cast<uint8_t>(seed >> 24);
    }
    return values;
}

}  // namespace citystream::tiles::layers
