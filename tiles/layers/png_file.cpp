#include "tiles/layers/png_file.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <csetjmp>
#include <filesystem>
#include <system_error>

namespace citystream::tiles::layers {
namespace {

constexpr size_t kSignatureBytes = 8;
constexpr uint64_t kMostDeflated = 1032;  // bytes that one byte of a zlib stream can stand for

// A warning is of something that can be read all the same (a colour profile, a wrong checksum of a comment).
void ignore_warning(png_structp, png_const_charp) {}

}  // namespace

bool PngFile::begins(const std::string& path) {
    std::array<png_byte, kSignatureBytes> bytes{};
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return false;
    const size_t read = std::fread(bytes.data(), 1, bytes.size(), file);
    (void)std::fclose(file);
    return read == bytes.size() && png_sig_cmp(bytes.data(), 0, bytes.size()) == 0;
}

/// A step of libpng; what it reports is the error. libpng leaves a failed step by a jump, so a step holds nothing that
/// has to be destroyed.
template <typename Step>
Status PngFile::run(const Step& step) {
    if (setjmp(png_jmpbuf(png_)) != 0) return Error{fault_};
    step();
    return Done{};
}

Result<std::unique_ptr<PngFile>> PngFile::open(const std::string& path, uint32_t greatest_side) {
    std::unique_ptr<PngFile> png(new PngFile);
    if (Status started = png->start(path, greatest_side); !started) return started.error();
    return png;
}

PngFile::~PngFile() {
    png_destroy_read_struct(&png_, &info_, nullptr);
    if (file_ != nullptr) (void)std::fclose(file_);
}

Status PngFile::start(const std::string& path, uint32_t greatest_side) {
    file_ = std::fopen(path.c_str(), "rb");
    if (file_ == nullptr) return Error{"the file cannot be opened"};
    std::error_code failed;
    file_bytes_ = std::filesystem::file_size(path, failed);
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, take_error, ignore_warning);
    if (png_ == nullptr) return Error{"libpng does not start"};
    info_ = png_create_info_struct(png_);
    if (info_ == nullptr) return Error{"libpng does not start"};
    png_set_read_fn(png_, this, take_bytes);
    return run([&] { read_header(greatest_side); });
}

void PngFile::read_header(uint32_t greatest_side) {
    png_set_user_limits(png_, greatest_side, greatest_side);
    png_read_info(png_, info_);
    const uint64_t stored_bytes = uint64_t{png_get_rowbytes(png_, info_)} * png_get_image_height(png_, info_);
    png_set_expand(png_);
    png_set_scale_16(png_);
    png_set_gray_to_rgb(png_);
    interlaced_ = png_set_interlace_handling(png_) > 1;
    png_read_update_info(png_, info_);
    width_ = png_get_image_width(png_, info_);
    height_ = png_get_image_height(png_, info_);
    channels_ = png_get_channels(png_, info_);
    const bool colours = channels_ == 3 || channels_ == 4;
    if (!colours || png_get_rowbytes(png_, info_) != size_t{width_} * channels_)
        png_error(png_, "its colours are of an unknown kind");
    if (interlaced_ && stored_bytes / kMostDeflated > file_bytes_) png_error(png_, "the file is cut off");
}

Status PngFile::read_rows(std::span<uint8_t> rows) {
    const size_t row_bytes = size_t{width_} * channels_;
    assert(rows.size() % row_bytes == 0 && rows.size() / row_bytes <= height_ - next_row_);
    if (interlaced_ && whole_.empty()) {
        if (Status read = read_interlaced(); !read) return read;
    }
    const size_t first = next_row_ * row_bytes;
    next_row_ += static_cast<uint32_t>(rows.size() / row_bytes);
    if (interlaced_) {
        std::copy_n(whole_.begin() + static_cast<std::ptrdiff_t>(first), rows.size(), rows.begin());
        return Done{};
    }
    return run([&] {
        for (size_t at = 0; at < rows.size(); at += row_bytes) png_read_row(png_, rows.data() + at, nullptr);
    });
}

Status PngFile::read_interlaced() {
    const size_t row_bytes = size_t{width_} * channels_;
    whole_.resize(row_bytes * height_);
    std::vector<png_bytep> rows(height_);
    for (size_t y = 0; y < rows.size(); ++y) rows[y] = whole_.data() + y * row_bytes;
    return run([&] { png_read_image(png_, rows.data()); });
}

void PngFile::take_bytes(png_structp png, png_bytep bytes, size_t count) {
    std::FILE* const file = static_cast<PngFile*>(png_get_io_ptr(png))->file_;
    if (std::fread(bytes, 1, count, file) != count) png_error(png, "the file is cut off");
}

void PngFile::take_error(png_structp png, png_const_charp message) {
    static_cast<PngFile*>(png_get_error_ptr(png))->fault_ = message;
    png_longjmp(png, 1);
}

}  // namespace citystream::tiles::layers
