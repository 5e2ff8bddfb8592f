// PNG files as rows of 8-bit colours, read by libpng itself with its own means to report: OpenImageIO's reader lets
// libpng print a line on stderr of every damaged file.
#pragma once

#include <png.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "codec/result.h"

namespace citystream::tiles::layers {

/// An open PNG file. Greys and palettes become RGB, 16 bits are rounded to 8, what is transparent becomes alpha;
/// colours are not multiplied by it. One thread at a time.
class PngFile {
  public:
    /// Whether the file begins as PNG files do.
    static bool begins(const std::string& path);
    /// Error: why the file cannot be read, a few words; sides above `greatest_side` are one reason.
    static Result<std::unique_ptr<PngFile>> open(const std::string& path, uint32_t greatest_side);
    ~PngFile();
    PngFile(const PngFile&) = delete;
    PngFile& operator=(const PngFile&) = delete;

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t channels() const { return channels_; }  ///< 3, or 4 with alpha

    /// Fills `rows` (whole rows, width() * channels() bytes each) with the next ones from the top, no more than remain.
    /// Interlaced files are read whole at the first call. Error: the file is damaged or cut off, a few words.
    Status read_rows(std::span<uint8_t> rows);

  private:
    PngFile() = default;
    template <typename Step>
    Status run(const Step& step);
    Status start(const std::string& path, uint32_t greatest_side);
    void read_header(uint32_t greatest_side);
    Status read_interlaced();
    static void take_bytes(png_structp png, png_bytep bytes, size_t count);
    [[noreturn]] static void take_error(png_structp png, png_const_charp message);

    std::FILE* file_ = nullptr;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    std::string fault_;
    uint64_t file_bytes_ = 0;
    uint32_t width_ = 0, height_ = 0, channels_ = 0, next_row_ = 0;
    bool interlaced_ = false;
    std::vector<uint8_t> whole_;  ///< of an interlaced file: no larger than a file of its bytes can be
};

}  // namespace citystream::tiles::layers
