#include "client/render/frame_file.h"

#include <OpenImageIO/imageio.h>

namespace citystream::client {
namespace {

constexpr int kMaxSide = 16384;

void expand_to_rgba(const std::vector<uint8_t>& from, int channels, std::vector<uint8_t>& rgba) {
    const size_t n = static_cast<size_t>(channels);
    for (size_t pixel = 0; pixel < rgba.size() / 4; ++pixel) {
        const uint8_t* source = &from[pixel * n];
        uint8_t* target = &rgba[pixel * 4];
        for (size_t c = 0; c < 3; ++c) target[c] = source[channels >= 3 ? c : 0];
        target[3] = channels == 2 || channels == 4 ? source[n - 1] : 255;
    }
}

}  // namespace

Status write_png(const std::string& path, const FrameImage& image) {
    if (image.width == 0 || image.height == 0 || image.rgba.size() != size_t{4} * image.width * image.height) {
        return Error{path + ": the frame has no pixels, or not as many as its size says"};
    }
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (!output) return Error{path + ": OpenImageIO has no PNG writer"};
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("png:compressionLevel", 3);
    if (!output->open(path, spec)) return Error{path + ": " + output->geterror()};
    // Strides of four bytes a pixel: alpha is stepped over.
    if (!output->write_image(OIIO::TypeDesc::UINT8, image.rgba.data(), 4,
                             4 * static_cast<OIIO::stride_t>(image.width)) ||
        !output->close()) {
        return Error{path + ": " + output->geterror()};
    }
    return Done{};
}

Result<FrameImage> read_png(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
    if (!input) return Error{path + ": " + OIIO::geterror()};
    const OIIO::ImageSpec& spec = input->spec();
    if (std::string(input->format_name()) != "png") return Error{path + ": not a PNG file"};
    if (spec.width < 1 || spec.height < 1 || spec.width > kMaxSide || spec.height > kMaxSide || spec.nchannels < 1 ||
        spec.nchannels > 4) {
        return Error{path + ": not a picture of at most 16384 x 16384 pixels and 4 channels"};
    }
    FrameImage image{static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height), {}};
    const size_t pixels = size_t{image.width} * image.height;
    const int channels = spec.nchannels;
    std::vector<uint8_t> data(pixels * static_cast<size_t>(channels));
    if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, data.data())) {
        return Error{path + ": " + input->geterror()};
    }
    image.rgba.resize(pixels * 4);
    expand_to_rgba(data, channels, image.rgba);
    return image;
}

}  // namespace citystream::client
