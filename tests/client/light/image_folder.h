// Floating-point pictures for tests, written by OpenImageIO or byte by byte into a folder that goes away.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "client/light/environment_map.h"
#include "tests/temporary_folder.h"

namespace citystream::client {

class LightFolder : public tests::TemporaryFolder {
  public:
    std::string path(const std::string& name = {}) const { return *this / name; }

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
};

}  // namespace citystream::client
