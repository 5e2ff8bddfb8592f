#include "tests/bench/block_images.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>

#include "codec/atlas/bc1.h"
#include "tests/bench/jpeg_file.h"

namespace citystream::bench {

namespace {

constexpr uint32_t kSide = 256;

template <typename Paint>
BlockImage painted(const std::string& name, Paint paint) {
    BlockImage image{name, kSide, kSide, std::vector<uint8_t>(3 * size_t{kSide} * kSide)};
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            double rgb[3];
            paint(static_cast<int>(x), static_cast<int>(y), rgb);
            for (size_t c = 0; c < 3; ++c)
                image.rgb[3 * (size_t{y} * kSide + x) + c] = static_cast<uint8_t>(std::clamp(rgb[c] + 0.5, 0.0, 255.0));
        }
    }
    return image;
}

void set_colour(double rgb[3], double r, double g, double b) {
    rgb[0] = r;
    rgb[1] = g;
    rgb[2] = b;
}

/// As fixed-function hardware has it: where c0 <= c1, code 2 is the middle of both and code 3 is black.
void decode_standard_bc1_texel(const uint32_t block[2], uint32_t texel, uint8_t rgb[3]) {
    const uint32_t code = block[1] >> (2 * texel) & 3;
    if ((block[0] & 0xffffU) > block[0] >> 16 || code < 2) return codec::atlas::decode_bc1_texel(block, texel, rgb);
    const uint32_t ends[2] = {block[0], 0b0100};
    uint8_t first[3], second[3];
    codec::atlas::decode_bc1_texel(ends, 0, first);
    codec::atlas::decode_bc1_texel(ends, 1, second);
    for (int c = 0; c < 3; ++c) rgb[c] = code == 3 ? uint8_t{0} : static_cast<uint8_t>((first[c] + second[c] + 1) / 2);
}

}  // namespace

BlockImage read_block_image(const std::string& file, uint32_t most_width, uint32_t most_height) {
    BlockImage image;
    image.name = std::filesystem::path(file).stem().string();
    const auto input = OIIO::ImageInput::open(file);
    if (!input || input->spec().nchannels < 3) return image;
    const auto width = static_cast<uint32_t>(input->spec().width), height = static_cast<uint32_t>(input->spec().height);
    std::vector<uint8_t> whole(3 * size_t{width} * height);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, whole.data())) return image;
    image.width = std::min(width, most_width) / 4 * 4;
    image.height = std::min(height, most_height) / 4 * 4;
    const size_t left = (width - image.width) / 2, top = (height - image.height) / 2;
    for (size_t y = 0; y < image.height; ++y) {
        const uint8_t* row = &whole[3 * ((top + y) * width + left)];
        image.rgb.insert(image.rgb.end(), row, row + 3 * size_t{image.width});
    }
    return image;
}

std::vector<std::string> shared_image_files(const std::string& set) {
    const std::filesystem::path data = CITYSTREAM_SOURCE_DIR "/../shared/data";
    const std::filesystem::path folder = data / (set == "kodak" ? "kodak"
                                                 : set == "cc0" ? "cc0_building_textures"
                                                                : "spb_facades/images");
    std::vector<std::string> files;
    if (!std::filesystem::exists(folder)) return files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string stem = entry.path().stem().string(), extension = entry.path().extension().string();
        const bool picture = extension == ".png" || extension == ".jpg";
        const bool data_map = stem.ends_with("_Normal") || stem.ends_with("_ORM") || stem.ends_with("_Displacement");
        if (picture && !data_map) files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<BlockImage> procedural_block_images() {
    std::mt19937 random(1);
    const auto noise = [&random](double range) { return range * (static_cast<double>(random() % 1024) / 512 - 1); };
    std::vector<BlockImage> images;
    images.push_back(painted("gradient", [](int x, int y, double* rgb) { set_colour(rgb, x, y, 128 + (x - y) / 4); }));
    images.push_back(painted("brick", [&](int x, int y, double* rgb) {
        const bool mortar = y % 16 < 2 || (x + y / 16 % 2 * 16) % 32 < 2;
        const double n = noise(8);
        mortar ? set_colour(rgb, 190 + n, 185 + n, 175 + n) : set_colour(rgb, 150 + n, 75 + n, 60 + n);
    }));
    images.push_back(painted("plaster", [&](int, int, double* rgb) {
        const double n = noise(6);
        set_colour(rgb, 214 + n, 205 + n, 190 + n);
    }));
    images.push_back(painted("windows", [](int x, int y, double* rgb) {
        const int u = x % 64, v = y % 64;
        const bool frame = u >= 14 && u < 50 && v >= 10 && v < 54, glass = u >= 18 && u < 46 && v >= 14 && v < 50;
        const bool bar = u % 32 < 2;
        if (glass && !bar) return set_colour(rgb, 40 + v, 60 + v, 80 + v);
        frame ? set_colour(rgb, 235, 235, 230) : set_colour(rgb, 200, 180, 140);
    }));
    images.push_back(painted("flat", [](int x, int y, double* rgb) {
        const int cell = x / 32 * 8 + y / 32;
        set_colour(rgb, 37 * cell % 256, 91 * cell % 256, 53 * cell % 256);
    }));
    images.push_back(painted("noise", [&](int, int, double* rgb) {
        for (int c = 0; c < 3; ++c) rgb[c] = 128 + noise(127);
    }));
    return images;
}

double psnr_of(const BlockImage& image, const std::vector<uint8_t>& shown) {
    double squares = 0;
    for (size_t i = 0; i < image.rgb.size(); ++i) {
        const double difference = static_cast<double>(image.rgb[i]) - static_cast<double>(shown[i]);
        squares += difference * difference;
    }
    return 10 * std::log10(255.0 * 255.0 / std::max(squares / static_cast<double>(image.rgb.size()), 1e-4));
}

std::vector<uint8_t> shown_by_blocks(const std::vector<uint32_t>& words, uint32_t width, uint32_t height,
                                     bool standard) {
    std::vector<uint8_t> rgb(3 * size_t{width} * height);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t* block = &words[2 * (size_t{y / 4} * (width / 4) + x / 4)];
            const uint32_t texel = y % 4 * 4 + x % 4;
            uint8_t* const shown = &rgb[3 * (size_t{y} * width + x)];
            if (standard)
                decode_standard_bc1_texel(block, texel, shown);
            else
                codec::atlas::decode_bc1_texel(block, texel, shown);
        }
    }
    return rgb;
}

JpegResult through_jpeg(const BlockImage& image, int quality) {
    const std::vector<unsigned char> file = jpeg_file(image.rgb, image.width, image.height, quality);
    const std::vector<uint8_t> shown = jpeg_pixels(file, image.width, image.height);
    if (shown.empty()) return {};
    return {file.size(), psnr_of(image, shown)};
}

}  // namespace citystream::bench
