// Image files as rows of RGB bytes and of alpha, whatever they hold: 8 or 16 bits, palette, grey, CMYK, tiles or
// scanlines. Colours are those that the file states beside its alpha (not multiplied by it). Files are read a
// strip of rows at a time, so that a picture need not fit into memory: PNG through libpng (png_file.h), all others
// through OpenImageIO.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "codec/atlas/atlas_layer.h"
#include "codec/result.h"

namespace citystream::tiles::layers {

using codec::atlas::ChartImage;

/// An open image file. One thread at a time.
class ImageFile {
  public:
    static constexpr uint64_t kGreatestPixels = uint64_t{1} << 30;
    static constexpr uint32_t kGreatestSide = 1 << 20;

    /// Error: one line that names the file, if it is no image (missing, empty, a folder, unknown) or larger than the
    /// limits above.
    static Result<std::unique_ptr<ImageFile>> open(const std::string& path);
    ~ImageFile();
    ImageFile(const ImageFile&) = delete;
    ImageFile& operator=(const ImageFile&) = delete;

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint64_t pixels() const { return uint64_t{width_} * height_; }
    bool has_alpha() const;  ///< the file has the channel, whatever is in it
    /// Memory that visit_rows takes beside what the decoder of the format holds.
    uint64_t strip_bytes() const;

    /// Takes `count` rows, the first of them `y` rows below the top: 3 * width() bytes each, and width() of alpha (none
    /// without the channel).
    using Visit =
        std::function<void(uint32_t y, uint32_t count, std::span<const uint8_t> rgb, std::span<const uint8_t> alpha)>;
    /// Reads the picture once from the top to the bottom. Error: one line, if the file is damaged or cut off.
    Status visit_rows(const Visit& visit);

  private:
    struct Input;
    explicit ImageFile(std::unique_ptr<Input> input);
    std::unique_ptr<Input> input_;
    uint32_t width_ = 0, height_ = 0;
};

/// The whole picture, row 0 at the bottom, as it is: see settle_alpha. Error: as above.
Result<ChartImage> read_whole(ImageFile& file);

/// A whole picture of at most 2^28 pixels, row 0 at the bottom, its alpha settled. Error: as above.
Result<ChartImage> decode_image(const std::string& path);

/// Forgets alpha that hides nothing, and gives what it hides the colours around (codec/atlas/alpha_mask.h).
void settle_alpha(ChartImage& image);

}  // namespace citystream::tiles::layers
