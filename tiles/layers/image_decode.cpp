#include "tiles/layers/image_decode.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "codec/atlas/alpha_mask.h"
#include "tiles/layers/png_file.h"

namespace citystream::tiles::layers {
namespace {

constexpr uint64_t kGreatestWholePixels = uint64_t{1} << 28;
constexpr uint32_t kStripRows = 64;
constexpr int kMostChannels = 16;

/// Libraries explain themselves in several lines, or not at all.
std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text.empty() ? "the file is damaged" : text;
}

void to_rgb(std::span<const uint8_t> raw, size_t channels, std::vector<uint8_t>& rgb) {
    const size_t pixels = raw.size() / channels;
    rgb.resize(3 * pixels);
    for (size_t i = 0; i < pixels; ++i) {
        for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = raw[i * channels + (channels < 3 ? 0 : c)];
    }
}

void pick_channel(std::span<const uint8_t> raw, size_t channels, size_t channel, std::vector<uint8_t>& out) {
    out.resize(raw.size() / channels);
    for (size_t i = 0; i < out.size(); ++i) out[i] = raw[i * channels + channel];
}

/// Limits that hold before anything is allocated by a size that a file claims.
Status check_size(int64_t width, int64_t height) {
    const auto good = [](int64_t side) { return side >= 1 && side <= ImageFile::kGreatestSide; };
    if (good(width) && good(height) && static_cast<uint64_t>(width * height) <= ImageFile::kGreatestPixels)
        return Done{};
    return Error{"size " + std::to_string(width) + " x " + std::to_string(height) + " is out of range"};
}

/// Rows of any format, through OpenImageIO.
struct AnyRows {
    std::unique_ptr<OIIO::ImageInput> file;
    OIIO::TypeDesc format;  ///< of every channel in the file
    size_t pixel_bytes = 0;
    bool tiled = false;
    int x = 0, y = 0, z = 0;  ///< of the top left pixel
    uint32_t width = 0, channels = 0;
    std::vector<uint8_t> native;

    Status read(uint32_t first, uint32_t count, std::vector<uint8_t>& raw) {
        const int begin = y + static_cast<int>(first), end = begin + static_cast<int>(count);
        const bool read = tiled ? file->read_tiles(0, 0, x, x + static_cast<int>(width), begin, end, z, z + 1, 0,
                                                   static_cast<int>(channels), OIIO::TypeDesc::UINT8, raw.data())
                                : read_scanlines(begin, end, raw);
        // Some formats note a fault and go on with what they have.
        if (!read || file->has_error()) return Error{file->geterror()};
        return Done{};
    }

  private:
    /// Native pixels are converted here: OpenImageIO's own conversion takes 64 MiB beside the rows.
    bool read_scanlines(int begin, int end, std::vector<uint8_t>& raw) {
        const bool same = format == OIIO::TypeDesc::UINT8;
        if (!same) native.resize(raw.size() / channels * pixel_bytes);
        if (!file->read_native_scanlines(0, 0, begin, end, z, same ? raw.data() : native.data())) return false;
        return same || OIIO::convert_pixel_values(format, native.data(), OIIO::TypeDesc::UINT8, raw.data(),
                                                  static_cast<int>(raw.size()));
    }
};

struct PngRows {
    std::unique_ptr<PngFile> file;

    Status read(uint32_t /*first*/, uint32_t /*count*/, std::vector<uint8_t>& raw) { return file->read_rows(raw); }
};

}  // namespace

struct ImageFile::Input {
    std::variant<AnyRows, PngRows> rows;
    std::string path;
    size_t native_bytes = 0;  ///< of a pixel, where they are held beside the rows
    uint32_t channels = 0, strip_rows = kStripRows;
    std::optional<uint32_t> alpha;  ///< channel
    uint32_t width = 0, height = 0;

    /// `count` rows from row `first` (counted from the top), all channels, 8 bits each. From the top to the bottom.
    Status read(uint32_t first, uint32_t count, std::vector<uint8_t>& raw) {
        raw.resize(size_t{count} * width * channels);
        return std::visit([&](auto& of_format) { return of_format.read(first, count, raw); }, rows);
    }

    Status open_png();
    Status open_any();
};

Status ImageFile::Input::open_png() {
    auto file = PngFile::open(path, kGreatestSide);
    if (!file) return file.error();
    width = (*file)->width();
    height = (*file)->height();
    channels = (*file)->channels();
    if (channels == 4) alpha = 3;
    rows = PngRows{std::move(*file)};
    return check_size(width, height);
}

Status ImageFile::Input::open_any() {
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    auto file = OIIO::ImageInput::open(path, &wishes);
    if (!file) return Error{OIIO::geterror()};
    const OIIO::ImageSpec& spec = file->spec();
    if (Status good = check_size(spec.width, spec.height); !good) return good;
    if (spec.nchannels < 1 || spec.nchannels > kMostChannels)
        return Error{std::to_string(spec.nchannels) + " channels are out of range"};
    if (!spec.channelformats.empty()) return Error{"its channels are of several types"};
    if (spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels)
        alpha = static_cast<uint32_t>(spec.alpha_channel);
    channels = static_cast<uint32_t>(spec.nchannels);
    width = static_cast<uint32_t>(spec.width);
    height = static_cast<uint32_t>(spec.height);
    native_bytes = spec.pixel_bytes(true);
    const bool tiled = spec.tile_width > 0;
    if (tiled) strip_rows = static_cast<uint32_t>(std::max(spec.tile_height, 1));
    rows = AnyRows{std::move(file), spec.format, native_bytes, tiled, spec.x, spec.y, spec.z, width, channels, {}};
    return Done{};
}

ImageFile::ImageFile(std::unique_ptr<Input> input)
    : input_(std::move(input)), width_(input_->width), height_(input_->height) {}

ImageFile::~ImageFile() = default;

Result<std::unique_ptr<ImageFile>> ImageFile::open(const std::string& path) {
    const auto fault = [&path](const std::string& why) { return Error{"cannot read image " + path + ": " + why}; };
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) return fault("there is no such file");
    if (!std::filesystem::is_regular_file(status)) return fault("it is no file");
    if (std::filesystem::file_size(path, failed) == 0) return fault("the file is empty");
    auto input = std::make_unique<Input>();
    input->path = path;
    const Status opened = PngFile::begins(path) ? input->open_png() : input->open_any();
    if (!opened) return fault(one_line(opened.error().text()));
    input->strip_rows = std::min(input->strip_rows, input->height);
    return std::unique_ptr<ImageFile>(new ImageFile(std::move(input)));
}

uint64_t ImageFile::strip_bytes() const {
    return uint64_t{width_} * input_->strip_rows *
           (3U + (has_alpha() ? 1U : 0U) + input_->channels + input_->native_bytes);
}

bool ImageFile::has_alpha() const {
    return input_->alpha.has_value();
}

Status ImageFile::visit_rows(const Visit& visit) {
    std::vector<uint8_t> raw, rgb, alpha;
    for (uint32_t y = 0; y < height_; y += input_->strip_rows) {
        const uint32_t count = std::min(input_->strip_rows, height_ - y);
        if (const Status read = input_->read(y, count, raw); !read)
            return Error{"cannot decode image " + input_->path + ": " + one_line(read.error().text())};
        to_rgb(raw, input_->channels, rgb);
        if (input_->alpha) pick_channel(raw, input_->channels, *input_->alpha, alpha);
        visit(y, count, rgb, alpha);
    }
    return Done{};
}

Result<ChartImage> read_whole(ImageFile& file) {
    ChartImage out{file.width(), file.height(), false, false, 0, {}};
    out.rgb.resize(3 * size_t{out.width} * out.height);
    if (file.has_alpha()) out.alpha.resize(size_t{out.width} * out.height);
    const auto copy_row = [&](std::span<const uint8_t> from, size_t row, uint32_t i, uint32_t y,
                              std::vector<uint8_t>& to) {
        std::copy_n(from.begin() + static_cast<ptrdiff_t>(i * row), row,
                    to.begin() + static_cast<ptrdiff_t>((out.height - 1 - y - i) * row));
    };
    const Status read =
        file.visit_rows([&](uint32_t y, uint32_t count, std::span<const uint8_t> rgb, std::span<const uint8_t> alpha) {
            for (uint32_t i = 0; i < count; ++i) {
                copy_row(rgb, size_t{3} * out.width, i, y, out.rgb);
                if (!alpha.empty()) copy_row(alpha, out.width, i, y, out.alpha);
            }
        });
    if (!read) return read.error();
    return out;
}

void settle_alpha(ChartImage& image) {
    if (codec::atlas::all_there(image.alpha)) image.alpha = {};
    codec::atlas::fill_hidden_colours(image);
}

Result<ChartImage> decode_image(const std::string& path) {
    auto file = ImageFile::open(path);
    if (!file) return file.error();
    ImageFile& rows = **file;
    if (rows.pixels() > kGreatestWholePixels) {
        return Error{"cannot use image " + path + ": " + std::to_string(rows.width()) + " x " +
                     std::to_string(rows.height()) + " pixels are too many"};
    }
    auto out = read_whole(rows);
    if (out) settle_alpha(*out);
    return out;
}

}  // namespace citystream::tiles::layers
