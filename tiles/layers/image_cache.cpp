#include "tiles/layers/image_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "codec/atlas/alpha_mask.h"

namespace citystream::tiles::layers {
namespace {

constexpr uint64_t kMeanTexels = 64 * 64;

size_t bytes_of(const ChartImage& image) {
    return image.rgb.size() + image.alpha.size();
}

uint64_t key_of(uint32_t image, uint32_t level) {
    return uint64_t{image} << 8 | level;
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
    double weights = 0;
    const size_t texels = size_t{image.width} * image.height;
    for (size_t i = 0; i < texels; ++i) {
        const double weight = image.alpha.empty() ? 1 : image.alpha[i];
        for (size_t c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(srgb_to_linear(image.rgb[3 * i + c]));
        weights += weight;
    }
    std::array<uint8_t, 3> mean{};
    for (size_t c = 0; c < 3; ++c) mean[c] = linear_to_srgb(static_cast<float>(sum[c] / std::max(weights, 1.0)));
    return mean;
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
    used_ += bytes_of(*pixels);
    peak_ = std::max(peak_, used_);
    while (used_ > budget_ && uses_.size() > 1) {
        const auto oldest = entries_.find(uses_.back());
        used_ -= bytes_of(*oldest->second.pixels);
        entries_.erase(oldest);
        uses_.pop_back();
    }
}

Result<ChartImage> ImageCache::decode(uint32_t image) const {
    const city::ImageSource& source = catalog_.images[image];
    const auto drawn = source.drawn();
    if (!drawn) return decode_image(source.path);
    if (drawn->width == 0 || drawn->height == 0 || drawn->rgb.size() != size_t{3} * drawn->width * drawn->height)
        return Error{"a drawn image is empty"};
    return ChartImage{drawn->width, drawn->height, false, false, 0, drawn->rgb};
}

std::shared_ptr<const ChartImage> ImageCache::give_up(uint32_t image, const std::string& why) {
    const std::string& path = catalog_.images[image].path;
    const std::lock_guard lock(mutex_);
    failed_.insert(image);
    defects_.push_back({path, why + "; a flat colour is used", path, false});
    return nullptr;
}

std::shared_ptr<const ChartImage> ImageCache::load(uint32_t image, uint32_t level) {
    auto read = prepared_->read(image, level);
    if (!read) return give_up(image, read.error().text());
    return std::make_shared<const ChartImage>(std::move(read).value());
}

/// A mip of an image that was not prepared, from the nearest finer one that is kept.
std::shared_ptr<const ChartImage> ImageCache::make(uint32_t image, uint32_t level) {
    std::shared_ptr<const ChartImage> pixels;
    uint32_t have = level;
    {
        const std::lock_guard lock(mutex_);
        for (have = level; !pixels && have-- > 0;) pixels = find(key_of(image, have));
    }
    if (!pixels) {
        auto decoded = decode(image);
        if (!decoded) return give_up(image, decoded.error().text());
        pixels = std::make_shared<const ChartImage>(std::move(decoded).value());
        have = 0;
        const std::lock_guard lock(mutex_);
        keep(key_of(image, 0), pixels);
    }
    for (; have < level && (pixels->width > 1 || pixels->height > 1); ++have)
        pixels = std::make_shared<const ChartImage>(codec::atlas::downsample(*pixels));
    return pixels;
}

std::shared_ptr<const ChartImage> ImageCache::mip(uint32_t image, uint32_t level) {
    if (image >= catalog_.images.size()) return nullptr;
    const auto state = prepared_ == nullptr ? PreparedImages::State::kUnknown : prepared_->state(image);
    if (state == PreparedImages::State::kFailed) return nullptr;
    if (state == PreparedImages::State::kStored) level = std::min(level, prepared_->levels(image) - 1);
    const std::lock_guard one_reader(read_mutex_[image % read_mutex_.size()]);
    {
        const std::lock_guard lock(mutex_);
        if (failed_.contains(image)) return nullptr;
        if (auto kept = find(key_of(image, level))) return kept;
    }
    auto pixels = state == PreparedImages::State::kStored ? load(image, level) : make(image, level);
    if (!pixels) return nullptr;
    const std::lock_guard lock(mutex_);
    keep(key_of(image, level), pixels);
    return pixels;
}

std::optional<std::array<uint32_t, 2>> ImageCache::sides(uint32_t image) {
    if (prepared_ != nullptr && image < catalog_.images.size() &&
        prepared_->state(image) == PreparedImages::State::kStored)
        return prepared_->sides(image);
    const auto finest = mip(image, 0);
    if (!finest) return std::nullopt;
    return std::array<uint32_t, 2>{finest->width, finest->height};
}

bool ImageCache::has_alpha(uint32_t image) {
    if (prepared_ != nullptr && image < catalog_.images.size() &&
        prepared_->state(image) != PreparedImages::State::kUnknown)
        return prepared_->has_alpha(image);
    const auto finest = mip(image, 0);
    return finest && !finest->alpha.empty();
}

/// The finest mip of few enough texels for a mean.
std::shared_ptr<const ChartImage> ImageCache::small_mip(uint32_t image) {
    uint32_t level = prepared_ == nullptr ? 0 : prepared_->level_of_size(image, kMeanTexels);
    auto pixels = mip(image, level);
    while (pixels && uint64_t{pixels->width} * pixels->height > kMeanTexels) pixels = mip(image, ++level);
    return pixels;
}

double ImageCache::there_share(uint32_t material) {
    const city::Material& m = catalog_.materials[material];
    if (m.image < 0) return 1;
    const auto image = static_cast<uint32_t>(m.image);
    {
        const std::lock_guard lock(mutex_);
        const auto found = there_.find(image);
        if (found != there_.end()) return found->second;
    }
    const auto pixels = has_alpha(image) ? small_mip(image) : nullptr;
    const double share = pixels ? codec::atlas::there_of(*pixels).value() : 1;
    const std::lock_guard lock(mutex_);
    return there_[image] = share;
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
    const auto pixels = small_mip(image);
    if (!pixels) return m.rgb;
    const auto mean = mean_of(*pixels);
    const std::lock_guard lock(mutex_);
    return means_[image] = mean;
}

size_t ImageCache::peak_bytes() const {
    const std::lock_guard lock(mutex_);
    return peak_;
}

std::vector<city::Defect> ImageCache::take_defects() {
    const std::lock_guard lock(mutex_);
    std::sort(defects_.begin(), defects_.end(),
              [](const city::Defect& a, const city::Defect& b) { return a.what < b.what; });
    return std::move(defects_);
}

}  // namespace citystream::tiles::layers
