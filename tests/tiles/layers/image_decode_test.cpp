// Image files of every kind give their colours as RGB bytes from the bottom row up; files that are none give one line.
#include "tiles/layers/image_decode.h"

#include <array>

#include "tests/tiles/layers/image_files.h"

// OpenImageIO 2.4 itself leaks the message of a PNG file that ends early: LeakSanitizer is told of that alone.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer's name.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:ImageInput::geterror\n";
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

namespace citystream::tiles::layers {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
using Bytes = std::vector<uint8_t>;

class ImageDecode : public testing::Test {
  protected:
    /// The pixels of a file; fails the test when it cannot be read.
    static ChartImage decoded(const std::string& path) {
        auto image = decode_image(path);
        EXPECT_TRUE(image.ok()) << (image ? "" : image.error().text());
        return image ? *std::move(image) : ChartImage();
    }
    /// The one line of a file that cannot be read.
    static std::string fault(const std::string& path) {
        const auto image = decode_image(path);
        EXPECT_FALSE(image.ok()) << path;
        const std::string text = image ? "" : image.error().text();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_NE(text.find(path), std::string::npos) << text;
        EXPECT_EQ(text.find("  "), std::string::npos) << text;
        return text;
    }
    ImageFolder folder_;
};

TEST_F(ImageDecode, TheBottomRowComesFirst) {
    const ChartImage image = decoded(folder_.write("rgb.png", 2, 2, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
    EXPECT_EQ(image.width, 2U);
    EXPECT_EQ(image.height, 2U);
    EXPECT_EQ(image.rgb, (Bytes{7, 8, 9, 10, 11, 12, 1, 2, 3, 4, 5, 6}));
}

TEST_F(ImageDecode, GreyIsTheSameInAllChannels) {
    EXPECT_EQ(decoded(folder_.write("grey.png", 2, 1, 1, {7, 200})).rgb, (Bytes{7, 7, 7, 200, 200, 200}));
}

TEST_F(ImageDecode, SixteenBitsAreRoundedToEight) {
    const std::vector<uint16_t> values = {0, 257, 65535, 128 * 257, 200 * 257 + 20, 3 * 257 - 20};
    const ImageSpec spec(2, 1, 3, TypeDesc::UINT16);
    EXPECT_EQ(decoded(folder_.write("deep.png", spec, values, TypeDesc::UINT16)).rgb, (Bytes{0, 1, 255, 128, 200, 3}));
}

TEST_F(ImageDecode, PaletteEntriesAreLookedUp) {
    // A BMP of 2 x 1 pixels with 8 bits each and two colours: header, information, palette (blue first), one padded
    // row.
    const std::string bytes(
        "BM\x42\0\0\0\0\0\0\0\x3e\0\0\0"
        "\x28\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\x08\0\0\0\0\0\x04\0\0\0\0\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0"
        "\x0a\x14\x1e\0\x28\x32\x3c\0"
        "\x01\0\0\0",
        66);
    EXPECT_EQ(decoded(folder_.write_bytes("palette.bmp", bytes)).rgb, (Bytes{60, 50, 40, 30, 20, 10}));
}

TEST_F(ImageDecode, InksBecomeColours) {
    ImageSpec spec(3, 1, 4, TypeDesc::UINT8);
    spec.attribute("tiff:ColorSpace", "CMYK");
    spec.channelnames = {"C", "M", "Y", "K"};
    // No ink, all of the magenta, all of the black.
    const Bytes inks = {0, 0, 0, 0, 0, 255, 0, 0, 0, 0, 0, 255};
    EXPECT_EQ(decoded(folder_.write("inks.tif", spec, inks, TypeDesc::UINT8)).rgb,
              (Bytes{255, 255, 255, 255, 0, 255, 0, 0, 0}));
}

TEST_F(ImageDecode, ColoursAreNotMultipliedByAlpha) {
    for (const char* name : {"alpha.png", "alpha.tif"}) {
        ImageSpec spec(2, 1, 4, TypeDesc::UINT8);
        spec.alpha_channel = 3;
        spec.attribute("oiio:UnassociatedAlpha", 1);
        const Bytes values = {200, 100, 50, 128, 10, 20, 30, 0};
        const auto file = ImageFile::open(folder_.write(name, spec, values, TypeDesc::UINT8));
        ASSERT_TRUE(file.ok()) << name;
        EXPECT_TRUE((*file)->has_alpha());
        const auto image = read_whole(**file);
        ASSERT_TRUE(image.ok()) << name;
        EXPECT_EQ(image->rgb, (Bytes{200, 100, 50, 10, 20, 30})) << name;
        EXPECT_EQ(image->alpha, (Bytes{128, 0})) << name;
    }
}

TEST_F(ImageDecode, AlphaIsKeptWhereItHidesSomethingAndHiddenColoursAreThoseAround) {
    const auto read_back = [&](const char* name, const Bytes& values) {
        ImageSpec spec(2, 1, 4, TypeDesc::UINT8);
        spec.alpha_channel = 3;
        spec.attribute("oiio:UnassociatedAlpha", 1);
        return decoded(folder_.write(name, spec, values, TypeDesc::UINT8));
    };
    const ChartImage holed = read_back("holed.png", {200, 100, 50, 128, 10, 20, 30, 0});
    EXPECT_EQ(holed.alpha, (Bytes{128, 0}));
    EXPECT_EQ(holed.rgb, (Bytes{200, 100, 50, 200, 100, 50}));
    const ChartImage solid = read_back("solid.png", {200, 100, 50, 255, 10, 20, 30, 128});
    EXPECT_TRUE(solid.alpha.empty());
    EXPECT_EQ(solid.rgb, (Bytes{200, 100, 50, 10, 20, 30}));
}

TEST_F(ImageDecode, TiledFilesAreReadLikeOthers) {
    constexpr int kWidth = 75, kHeight = 50;
    const Bytes values = noise(size_t{3} * kWidth * kHeight);
    ImageSpec spec(kWidth, kHeight, 3, TypeDesc::UINT8);
    const ChartImage rows = decoded(folder_.write("rows.tif", spec, values, TypeDesc::UINT8));
    spec.tile_width = spec.tile_height = 16;
    const ChartImage tiles = decoded(folder_.write("tiles.tif", spec, values, TypeDesc::UINT8));
    EXPECT_EQ(tiles.rgb, rows.rgb);
    EXPECT_EQ(tiles.rgb[0], values[size_t{3} * kWidth * (kHeight - 1)]);
}

TEST_F(ImageDecode, LinesOfOnePixelAreImages) {
    for (const auto& [width, height] :
         {std::array{1, 700}, std::array{700, 1}, std::array{16384, 1}, std::array{1, 1}}) {
        const Bytes values = noise(static_cast<size_t>(width * height));
        const ChartImage image = decoded(folder_.write("line.png", width, height, 1, values));
        ASSERT_EQ(image.rgb.size(), 3 * values.size());
        for (size_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(image.rgb[3 * (values.size() - 1 - i)], values[height == 1 ? values.size() - 1 - i : i]);
    }
}

TEST_F(ImageDecode, WhatIsNoImageIsOneLine) {
    EXPECT_NE(fault(folder_.path("absent.png")).find("no such file"), std::string::npos);
    EXPECT_NE(fault(folder_.write_bytes("empty.jpg", "")).find("empty"), std::string::npos);
    std::filesystem::create_directory(folder_.path("folder.png"));
    EXPECT_NE(fault(folder_.path("folder.png")).find("no file"), std::string::npos);
    fault(folder_.write_bytes("text.png", "this is no picture"));
    fault(folder_.write_bytes("text.unknown", "this is no picture"));
}

TEST_F(ImageDecode, ACutOffFileIsOneLine) {
    folder_.write("whole.png", 64, 64, 3, noise(3 * 64 * 64));
    folder_.write("whole.tif", 64, 64, 3, noise(3 * 64 * 64));
    for (const std::string name : {"whole.png", "whole.tif"}) {
        const std::string bytes = folder_.bytes_of(name);
        for (const size_t part : {size_t{1}, bytes.size() / 4, bytes.size() / 2})
            fault(folder_.write_bytes("cut_" + name, bytes.substr(0, part)));
    }
}

TEST_F(ImageDecode, AnImageBeyondAllLimitsIsOneLine) {
    // Headers only: nothing of the claimed size may be allocated.
    std::string header("BM\x36\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\0\0\0\x40\0\0\0\x01\x01\0\x18\0", 30);
    header.resize(54);
    fault(folder_.write_bytes("wide.bmp", header));
    folder_.write("small.png", 4, 4, 3, noise(48));
    std::string bytes = folder_.bytes_of("small.png");
    bytes.replace(16, 8, std::string("\x00\x02\x00\x00\x00\x02\x00\x00", 8));  // 131072 x 131072
    fault(folder_.write_bytes("large.png", bytes));
}

TEST_F(ImageDecode, StripsOfRowsAreTheWholePicture) {
    constexpr uint32_t kWidth = 33, kHeight = 200;
    const Bytes values = noise(size_t{3} * kWidth * kHeight);
    auto file = ImageFile::open(folder_.write("strips.png", kWidth, kHeight, 3, values));
    ASSERT_TRUE(file.ok());
    Bytes read;
    uint32_t next = 0;
    ASSERT_TRUE((*file)->visit_rows([&](uint32_t y, uint32_t count, std::span<const uint8_t> rgb, auto) {
        EXPECT_EQ(y, next);
        EXPECT_EQ(rgb.size(), size_t{3} * kWidth * count);
        EXPECT_LE(2 * rgb.size(), (*file)->strip_bytes());
        next += count;
        read.insert(read.end(), rgb.begin(), rgb.end());
    }));
    EXPECT_EQ(next, kHeight);
    EXPECT_EQ(read, values);
}

}  // namespace
}  // namespace citystream::tiles::layers
