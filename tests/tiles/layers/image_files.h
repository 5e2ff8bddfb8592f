// Image files for tests, written by OpenImageIO or byte by byte.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace citystream::tiles::layers {

class ImageFolder : public tests::TemporaryFolder {
  public:
    std::string path(const std::string& name = {}) const { return *this / name; }

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
