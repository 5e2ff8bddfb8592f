#include "tiles/layers/image_cache.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace citystream::tiles::layers {
namespace {

constexpr int64_t kGreatestPixels = int64_t{1} << 28;
constexpr uint64_t kMeanTexels = 64 * 64;

ChartImage to_rgb(const std::vector<uint8_t>& raw, uint32_t width, uint32_t height, uint32_t channels) {
    ChartImage out;
    out.width = width;
    out.height = height;
    out.rgb.resize(size_t{3} * width * height);
    for (uint32_t y = 0; y < height; ++y) {
        const uint8_t* source = raw.data() + size_t{height - 1 - y} * width * channels;
        uint8_t* target = out.rgb.data() + size_t{3} * y * width;
        for (uint32_t x = 0; x < width; ++x, source += channels, target += 3) {
            const bool grey = channels < 3;
            target[0] = source[0];
            target[1] = grey ? source[0] : source[1];
            target[2] = grey ? source[0] : source[2];
        }
    }
    return out;
}

std::array<float, 256> make_linear_table() {
    std::array<float, 256> table{};
    for (size_t i = 0; i < table.size(); ++i) {
        const double s = static_cast<double>(i) / 255.0;
        table[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
    }
    return table;
}

}  // namespace

float srgb_to_linear(uint8_t value) {
    static const std::array<float, 256> kTable = make_linear_table();
    return kTable[value];
}

uint8_t linear_to_srgb(float value) {
    const float c = std::clamp(value, 0.0F, 1.0F);
    const float s = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F;
    return static_cast<uint8_t>(std::lround(s * 255.0F));
}

std::array<uint8_t, 3> rounded_colour(const std::array<uint8_t, 3>& rgb) {
    std::array<uint8_t, 3> out{};
    for (size_t c = 0; c < 3; ++c) {
        const int five = rgb[c] * 31 / 255;
        out[c] = static_cast<uint8_t>(five << 3 | five >> 2);
    }
    return out;
}

std::array<uint8_t, 3> mean_of(const ChartImage& image) {
    std::array<double, 3> sum{};
    const size_t texels = size_t{image.width} * image.height;
    for (size_t i = 0; i < texels; ++i) {
        for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<double>(srgb_to_linear(image.rgb[3 * i + c]));
    }
    std::array<uint8_t, 3> mean{};
    for (size_t c = 0; c < 3; ++c)
        mean[c] = linear_to_srgb(static_cast<float>(sum[c] / static_cast<double>(std::max<size_t>(texels, 1))));
    return mean;
}

Result<ChartImage> decode_image(const std::string& path) {
    auto input = OIIO::ImageInput::open(path);
    if (!input) return Error{"cannot read image " + path + ": " + OIIO::geterror()};
    const OIIO::ImageSpec spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 ||
        int64_t{spec.width} * spec.height > kGreatestPixels || spec.nchannels > 16) {
        return Error{"cannot use image " + path + ": size " + std::to_string(spec.width) + " x " +
                     std::to_string(spec.height)};
    }
    std::vector<uint8_t> raw(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height) *
                             static_cast<size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, raw.data())) {
        return Error{"cannot decode image " + path + ": " + input->geterror()};
    }
    return to_rgb(raw, static_cast<uint32_t>(spec.width), static_cast<uint32_t>(spec.height),
                  static_cast<uint32_t>(spec.nchannels));
}

std::shared_ptr<const ChartImage> ImageCache::find(uint64_t key) {
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    uses_.splice(uses_.begin(), uses_, found->second.use);
    return found->second.pixels;
}

void ImageCache::keep(uint64_t key, const std::shared_ptr<const ChartImage>& pixels) {
    if (entries_.count(key) != 0) return;
    uses_.push_front(key);
    entries_[key] = {pixels, uses_.begin()};
    used_ += pixels->rgb.size();
    while (used_ > budget_ && uses_.size() > 1) {
        const auto oldest = entries_.find(uses_.back());
        used_ -= oldest->second.pixels->rgb.size();
        entries_.erase(oldest);
        uses_.pop_back();
    }
}

std::shared_ptr<const ChartImage> ImageCache::decode(uint32_t image) {
    const city::ImageSource& source = catalog_.images[image];
    if (source.pixels) {
        const city::Image& p = *source.pixels;
        if (p.width == 0 || p.height == 0 || p.rgb.size() != size_t{3} * p.width * p.height) return nullptr;
        return std::make_shared<const ChartImage>(ChartImage{p.width, p.height, false, false, 0, p.rgb});
    }
    auto decoded = decode_image(source.path);
    if (decoded) return std::make_shared<const ChartImage>(std::move(decoded).value());
    const std::lock_guard lock(mutex_);
    defects_.push_back({source.path, decoded.error().text() + "; a flat colour is used", source.path, false});
    return nullptr;
}

std::shared_ptr<const ChartImage> ImageCache::mip(uint32_t image, uint32_t level) {
    if (image >= catalog_.images.size()) return nullptr;
    const uint64_t key = uint64_t{image} << 8 | level;
    const std::lock_guard one_decoder(decode_mutex_[image % decode_mutex_.size()]);
    uint32_t have = 0;
    std::shared_ptr<const ChartImage> pixels;
    {
        const std::lock_guard lock(mutex_);
        if (failed_.count(image) != 0) return nullptr;
        for (have = level + 1; have-- > 0 && !pixels;) pixels = find(uint64_t{image} << 8 | have);
        have = pixels ? have + 1 : 0;
    }
    if (!pixels) {
        pixels = decode(image);
        const std::lock_guard lock(mutex_);
        if (!pixels) {
            failed_[image] = true;
            return nullptr;
        }
        keep(uint64_t{image} << 8, pixels);
    }
    if (have == level) return pixels;
    for (; have < level && (pixels->width > 1 || pixels->height > 1); ++have) {
        pixels = std::make_shared<const ChartImage>(codec::atlas::downsample(*pixels));
    }
    const std::lock_guard lock(mutex_);
    keep(key, pixels);
    return pixels;
}

std::array<uint8_t, 3> ImageCache::mean_colour(uint32_t material) {
    const city::Material& m = catalog_.materials[material];
    if (m.image < 0) return m.rgb;
    const auto image = static_cast<uint32_t>(m.image);
    {
        const std::lock_guard lock(mutex_);
        const auto found = means_.find(image);
        if (found != means_.end()) return found->second;
    }
    auto pixels = mip(image, 0);
    if (!pixels) return m.rgb;
    uint32_t level = 0;
    while ((uint64_t{pixels->width >> level} * (pixels->height >> level)) > kMeanTexels) ++level;
    const auto mean = mean_of(*mip(image, level));
    const std::lock_guard lock(mutex_);
    return means_[image] = mean;
}

std::vector<city::Defect> ImageCache::take_defects() {
    const std::lock_guard lock(mutex_);
    std::sort(defects_.begin(), defects_.end(),
              [](const city::Defect& a, const city::Defect& b) { return a.what < b.what; });
    return std::move(defects_);
}

}  // namespace citystream::tiles::layers
