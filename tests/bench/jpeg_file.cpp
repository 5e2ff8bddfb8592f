#include "tests/bench/jpeg_file.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string>

namespace citystream::bench {

std::vector<unsigned char> jpeg_file(std::span<const uint8_t> rgb, uint32_t width, uint32_t height, int quality) {
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const auto output = OIIO::ImageOutput::create("image.jpg", &memory);
    OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Compression", "jpeg:" + std::to_string(quality));
    const bool written = output && output->open("image.jpg", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) && output->close();
    return written ? file : std::vector<unsigned char>();
}

std::vector<uint8_t> jpeg_pixels(const std::vector<unsigned char>& file, uint32_t width, uint32_t height) {
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(file.data()), file.size());
    const auto input = OIIO::ImageInput::open("image.jpg", nullptr, &memory);
    if (!input || input->spec().width != static_cast<int>(width) || input->spec().height != static_cast<int>(height))
        return {};
    std::vector<uint8_t> pixels(size_t{3} * width * height);
    return input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, pixels.data()) ? pixels : std::vector<uint8_t>();
}

}  // namespace citystream::bench
