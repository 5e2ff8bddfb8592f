// Floating-point pictures for tests, written by OpenImageIO or byte by byte into a folder that goes away.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "client/light/environment_map.h"

namespace citystream::client {

class LightFolder {
  public:
    LightFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "citystream-light-XXXXXX").string();
        EXPECT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    ~LightFolder() { std::filesystem::remove_all(folder_); }
    LightFolder(const LightFolder&) = delete;
    LightFolder& operator=(const LightFolder&) = delete;
    std::string path(const std::string& name = {}) const { return (folder_ / name).string(); }

    std::string write(const std::string& name, OIIO::ImageSpec spec, const std::vector<float>& values) const {
        auto output = OIIO::ImageOutput::create(path(name));
        EXPECT_TRUE(output) << name;
        if (!output) return path(name);
        EXPECT_TRUE(output->open(path(name), spec)) << output->geterror();
        EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data())) << output->geterror();
        EXPECT_TRUE(output->close()) << output->geterror();
        return path(name);
    }
    /// Texels row by row from the top.
    std::string write(const std::string& name, uint32_t width, uint32_t height, const std::vector<Rgb>& texels) const {
        std::vector<float> values;
        for (const Rgb& texel : texels) values.insert(values.end(), texel.begin(), texel.end());
        return write(name, OIIO::ImageSpec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::FLOAT),
                     values);
    }
    std::string write_bytes(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }
    std::string bytes_of(const std::string& name) const {
        std::ifstream file(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    }

  private:
    std::filesystem::path folder_;
};

}  // namespace citystream::client
