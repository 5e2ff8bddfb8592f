#include "client/light/environment_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "client/light/cube_picture.h"

namespace citystream::client {
namespace {

constexpr uint32_t kStripRows = 64;
constexpr uint32_t kGreatestSide = 1 << 16;
constexpr uint64_t kGreatestStripValues = uint64_t{1} << 26;
constexpr int kMostChannels = 64;
constexpr float kGreatestHalf = 65504.0F;

/// Libraries explain themselves in several lines, or not at all.
std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text.empty() ? "the file is damaged" : text;
}

float linear_of_srgb(float v) {
    return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

/// Rows of linear colour out of an open file.
class PictureRows {
  public:
    static Result<PictureRows> open(const std::string& file) {
        PictureRows rows;
        rows.input_ = OIIO::ImageInput::open(file);
        if (!rows.input_) return Error{one_line(OIIO::geterror())};
        const OIIO::ImageSpec& spec = rows.input_->spec();
        if (const Status good = check(spec); !good) return good.error();
        rows.width_ = static_cast<uint32_t>(spec.width);
        rows.height_ = static_cast<uint32_t>(spec.height);
        rows.channels_ = spec.nchannels < 3 ? 1 : 3;
        rows.tiled_ = spec.tile_width > 0;
        rows.coded_ = !spec.format.is_floating_point();
        const bool is_cube = spec.get_string_attribute("textureformat") == "CubeFace Environment";
        if (is_cube && rows.input_->format_name() == std::string_view("openexr")) rows.cube_axes_ = CubeAxes::kOpenExr;
        rows.strip_ = std::min(rows.tiled_ ? static_cast<uint32_t>(spec.tile_height) : kStripRows, rows.height_);
        if (uint64_t{rows.strip_} * rows.width_ * rows.channels_ > kGreatestStripValues)
            return Error{"its tiles are too large"};
        return rows;
    }

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    CubeAxes cube_axes() const { return cube_axes_; }

    /// Calls visit(row) for each row from the top.
    template <typename Visit>
    Status visit(Visit&& visit) {
        std::vector<float> values;
        std::vector<Rgb> row(width_);
        for (uint32_t first = 0; first < height_; first += strip_) {
            const uint32_t count = std::min(strip_, height_ - first);
            values.resize(size_t{count} * width_ * channels_);
            if (const Status read = read_strip(first, count, values); !read) return read.error();
            for (uint32_t i = 0; i < count; ++i) {
                take_row(values.data() + size_t{i} * width_ * channels_, row);
                visit(row);
            }
        }
        return Done{};
    }

  private:
    static Status check(const OIIO::ImageSpec& spec) {
        const auto good = [](int64_t side) { return side >= 1 && side <= kGreatestSide; };
        if (!good(spec.width) || !good(spec.height) ||
            uint64_t(spec.width) * uint64_t(spec.height) > kGreatestFilePixels) {
            return Error{"size " + std::to_string(spec.width) + " x " + std::to_string(spec.height) +
                         " is out of range (at most 2^28 pixels)"};
        }
        if (spec.nchannels < 1 || spec.nchannels > kMostChannels)
            return Error{std::to_string(spec.nchannels) + " channels are out of range"};
        if (spec.depth > 1 || spec.deep) return Error{"it is no flat picture"};
        if (const int order = spec.get_int_attribute("Orientation", 1); order != 1)
            return Error{"it is stored turned or mirrored (orientation " + std::to_string(order) +
                         "): save it with rows from the top, each from the left"};
        if (spec.tile_width < 0 || spec.tile_height < (spec.tile_width > 0 ? 1 : 0))
            return Error{"its tiles have no size"};
        return Done{};
    }

    Status read_strip(uint32_t first, uint32_t count, std::vector<float>& values) {
        const OIIO::ImageSpec& spec = input_->spec();
        const int begin = spec.y + static_cast<int>(first), end = begin + static_cast<int>(count);
        const auto channels = static_cast<int>(channels_);
        const bool read = tiled_ ? input_->read_tiles(0, 0, spec.x, spec.x + spec.width, begin, end, spec.z, spec.z + 1,
                                                      0, channels, OIIO::TypeDesc::FLOAT, values.data())
                                 : input_->read_scanlines(0, 0, begin, end, spec.z, 0, channels, OIIO::TypeDesc::FLOAT,
                                                          values.data());
        // Some formats note a fault and go on with what they have.
        if (!read || input_->has_error()) return Error{one_line(input_->geterror())};
        return Done{};
    }

    void take_row(const float* values, std::vector<Rgb>& row) const {
        for (uint32_t x = 0; x < width_; ++x) {
            for (size_t c = 0; c < 3; ++c) {
                const float v = values[x * channels_ + (channels_ == 3 ? c : 0)];
                row[x][c] = coded_ ? linear_of_srgb(v) : v;
            }
        }
    }

    std::unique_ptr<OIIO::ImageInput> input_;
    uint32_t width_ = 0, height_ = 0, channels_ = 3, strip_ = 1;
    bool tiled_ = false, coded_ = false;
    CubeAxes cube_axes_ = CubeAxes::kOpenGl;
};

Result<EnvironmentFile> read_rows(PictureRows& rows) {
    std::optional<CubePicture> cube;
    std::optional<MapReduction> map;
    if (rows.width() == 2 * rows.height())
        map.emplace(rows.width(), rows.height(), kGreatestMapWidth, kGreatestMapWidth / 2);
    else
        cube = CubePicture::of_size(rows.width(), rows.height(), rows.cube_axes());
    const std::string size = std::to_string(rows.width()) + " x " + std::to_string(rows.height());
    if (!map && !cube) {
        return Error{size +
                     " is no shape of an environment map (latitude and longitude 2:1, crosses 4:3 or 3:4, strips "
                     "of faces 6:1 or 1:6)"};
    }
    if (cube && cube->face_side() > kGreatestFaceSide)
        return Error{"faces of " + std::to_string(cube->face_side()) + " pixels are too large (at most 2048)"};
    EnvironmentFile file;
    const Status read = rows.visit([&](std::vector<Rgb>& row) {
        for (Rgb& texel : row) mend_texel(texel, file.defects);
        map ? map->add_row(row) : cube->add_row(row);
    });
    if (!read) return read.error();
    if (file.defects.all() == uint64_t{rows.width()} * rows.height()) return Error{"no texel of it is a radiance"};
    file.map = map ? map->take() : cube->take(kGreatestMapWidth);
    return file;
}

}  // namespace

void mend_texel(Rgb& texel, TexelDefects& defects) {
    bool nan = false, infinite = false, negative = false, great = false;
    for (float& v : texel) {
        nan |= std::isnan(v);
        infinite |= v > 0 && std::isinf(v);
        negative |= v < 0;
        great |= v > kGreatestRadiance && !std::isinf(v);
        v = v > 0 ? std::min(std::isinf(v) ? kGreatestHalf : v, kGreatestRadiance) : 0.0F;
    }
    defects.not_a_number += nan;
    defects.infinite += !nan && infinite;
    defects.negative += !nan && !infinite && negative;
    defects.too_great += !nan && !infinite && !negative && great;
}

std::string TexelDefects::text() const {
    if (all() == 0) return {};
    std::string parts;
    const auto add = [&parts](uint64_t count, const char* what) {
        if (count > 0) parts += (parts.empty() ? "" : ", ") + std::to_string(count) + " " + what;
    };
    add(not_a_number, "not a number");
    add(infinite, "infinite");
    add(negative, "negative");
    add(too_great, "too great");
    return std::to_string(all()) + (all() == 1 ? " texel" : " texels") + " mended: " + parts;
}

Result<EnvironmentFile> read_environment(const std::string& file) {
    const auto fault = [&file](const std::string& why) {
        return Error{"cannot read environment map " + file + ": " + why};
    };
    std::error_code failed;
    const auto status = std::filesystem::status(file, failed);
    if (!std::filesystem::exists(status)) return fault("there is no such file");
    if (!std::filesystem::is_regular_file(status)) return fault("it is no file");
    if (std::filesystem::file_size(file, failed) == 0) return fault("the file is empty");
    Result<PictureRows> rows = PictureRows::open(file);
    if (!rows) return fault(rows.error().text());
    Result<EnvironmentFile> environment = read_rows(*rows);
    if (!environment) return fault(environment.error().text());
    return environment;
}

}  // namespace citystream::client
