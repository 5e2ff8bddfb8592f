#include "tiles/layers/png_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/tiles/layers/image_files.h"

namespace citystream::tiles::layers {
namespace {

constexpr uint32_t kMostSide = 1 << 20;

/// A kind of PNG: 19 x 13 texels of noise.
struct Kind {
    int colours = PNG_COLOR_TYPE_RGB, depth = 8;
    bool interlaced = false, transparent = false;  ///< transparent: entries of the palette, or one colour
};
constexpr uint32_t kWidth = 19, kHeight = 13;

uint32_t samples_of(int colours) {
    if (colours == PNG_COLOR_TYPE_RGB) return 3;
    if (colours == PNG_COLOR_TYPE_RGB_ALPHA) return 4;
    return colours == PNG_COLOR_TYPE_GRAY_ALPHA ? 2 : 1;
}

void write_transparency(png_structp png, png_infop info, const Kind& kind) {
    png_byte alpha[4] = {0, 90, 255, 17};
    png_color_16 colour{};
    colour.gray = 1;
    if (kind.colours == PNG_COLOR_TYPE_PALETTE)
        png_set_tRNS(png, info, alpha, 4, nullptr);
    else
        png_set_tRNS(png, info, nullptr, 0, &colour);
}

void write_png(const std::string& path, const Kind& kind) {
    std::FILE* const file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, kWidth, kHeight, kind.depth, kind.colours,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
                 PNG_FILTER_TYPE_BASE);
    png_color palette[256];
    for (int i = 0; i < 256; ++i)
        palette[i] = {static_cast<png_byte>(7 * i), static_cast<png_byte>(255 - i), static_cast<png_byte>(i * i)};
    if (kind.colours == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 1 << kind.depth);
    if (kind.transparent) write_transparency(png, info, kind);
    png_write_info(png, info);
    const size_t row_bytes = (size_t{kWidth} * samples_of(kind.colours) * static_cast<size_t>(kind.depth) + 7) / 8;
    std::vector<uint8_t> values = noise(row_bytes * kHeight);
    std::vector<png_bytep> rows;
    for (size_t y = 0; y < kHeight; ++y) rows.push_back(values.data() + y * row_bytes);
    png_write_image(png, rows.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    ASSERT_EQ(std::fclose(file), 0);
}

/// What OpenImageIO reads, with greys spread over RGB.
std::vector<uint8_t> read_by_peer(const std::string& path) {
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = OIIO::ImageInput::open(path, &wishes);
    if (!input) return {};
    const auto channels = static_cast<size_t>(input->spec().nchannels);
    std::vector<uint8_t> raw(channels * kWidth * kHeight), out;
    EXPECT_TRUE(input->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, raw.data()));
    for (size_t i = 0; i < raw.size(); i += channels) {
        for (size_t c = 0; c < 3; ++c) out.push_back(raw[i + (channels < 3 ? 0 : c)]);
        if (channels % 2 == 0) out.push_back(raw[i + channels - 1]);
    }
    return out;
}

/// The whole file in two reads.
Result<std::vector<uint8_t>> read_ours(const std::string& path) {
    auto file = PngFile::open(path, kMostSide);
    if (!file) return file.error();
    PngFile& png = **file;
    const size_t row = size_t{png.width()} * png.channels();
    std::vector<uint8_t> out(row * png.height());
    const size_t part = row * (png.height() / 3);
    if (Status read = png.read_rows(std::span(out).first(part)); !read) return read.error();
    if (Status read = png.read_rows(std::span(out).subspan(part)); !read) return read.error();
    return out;
}

TEST(PngFile, ShowsOfEveryKindWhatOpenImageIoShows) {
    const ImageFolder folder;
    const std::vector<std::pair<int, std::vector<int>>> kinds = {{PNG_COLOR_TYPE_GRAY, {1, 2, 4, 8, 16}},
                                                                 {PNG_COLOR_TYPE_GRAY_ALPHA, {8, 16}},
                                                                 {PNG_COLOR_TYPE_RGB, {8, 16}},
                                                                 {PNG_COLOR_TYPE_RGB_ALPHA, {8, 16}},
                                                                 {PNG_COLOR_TYPE_PALETTE, {2, 4, 8}}};
    const std::string path = folder.path("kind.png");
    for (const auto& [colours, depths] : kinds) {
        for (const int depth : depths) {
            for (const bool interlaced : {false, true}) {
                for (const bool transparent : {false, true}) {
                    if (transparent && (colours & PNG_COLOR_MASK_ALPHA) != 0) continue;
                    write_png(path, {colours, depth, interlaced, transparent});
                    EXPECT_TRUE(PngFile::begins(path));
                    const auto ours = read_ours(path);
                    ASSERT_TRUE(ours) << ours.error().text();
                    EXPECT_EQ(*ours, read_by_peer(path))
                        << colours << ' ' << depth << ' ' << interlaced << ' ' << transparent;
                }
            }
        }
    }
}

TEST(PngFile, EveryDamageIsAReasonAndLibpngPrintsNothing) {
    const ImageFolder folder;
    for (const bool interlaced : {false, true}) {
        write_png(folder.path("whole.png"), {PNG_COLOR_TYPE_RGB, 8, interlaced});
        const std::string bytes = folder.bytes_of("whole.png");
        const size_t data_end = bytes.size() - 12 - 4;  // the last chunk, and the checksum of the pixels
        testing::internal::CaptureStderr();
        for (size_t length = 9; length < data_end; length += 7) {
            const auto read = read_ours(folder.write_bytes("cut.png", bytes.substr(0, length)));
            ASSERT_FALSE(read) << length;
            EXPECT_FALSE(read.error().text().empty()) << length;
        }
        for (size_t at = 8; at < data_end; at += 5) {
            std::string damaged = bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
            (void)read_ours(folder.write_bytes("damaged.png", damaged));  // pixels may come out: the last checksum
        }
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    }
}

TEST(PngFile, AWarningOfLibpngsIsNotPrinted) {
    const ImageFolder folder;
    write_png(folder.path("plain.png"), {});
    std::string bytes = folder.bytes_of("plain.png");
    constexpr size_t kHeaderEnd = 8 + 25;
    // A gamma chunk with a wrong checksum, which libpng warns of and skips.
    bytes.insert(kHeaderEnd, std::string("\0\0\0\4gAMA\0\0\xb1\x8f????", 16));
    testing::internal::CaptureStderr();
    const auto read = read_ours(folder.write_bytes("warned.png", bytes));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(*read, read_by_peer(folder.path("plain.png")));
}

TEST(PngFile, AClaimedSizeAllocatesNothing) {
    const ImageFolder folder;
    write_png(folder.path("small.png"), {PNG_COLOR_TYPE_RGB, 8, true});
    std::string bytes = folder.bytes_of("small.png");
    // 32768 x 32768 texels, with the checksum that goes with them.
    bytes.replace(16, 8, std::string("\0\0\x80\0\0\0\x80\0", 8));
    std::vector<Bytef> header(bytes.begin() + 12, bytes.begin() + 29);
    const auto sum = static_cast<uint32_t>(crc32(0, header.data(), static_cast<uInt>(header.size())));
    for (size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<char>(sum >> (24 - 8 * i));
    const auto read = PngFile::open(folder.write_bytes("claims.png", bytes), kMostSide);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().text().find("cut off"), std::string::npos) << read.error().text();
    EXPECT_FALSE(PngFile::open(folder.path("claims.png"), 1000));
}

}  // namespace
}  // namespace citystream::tiles::layers
