#include "tiles/layers/prepared_images.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

namespace citystream::tiles::layers {
namespace {

uint32_t mip_side(uint32_t side, uint32_t level) {
    return std::max(1U, side >> level);
}

uint64_t mip_texels(uint32_t width, uint32_t height, uint32_t level) {
    return uint64_t{mip_side(width, level)} * mip_side(height, level);
}

uint32_t mip_count(uint32_t width, uint32_t height) {
    return static_cast<uint32_t>(std::bit_width(std::max(width, height)));
}

}  // namespace

Result<std::unique_ptr<PreparedImages>> PreparedImages::create(const std::string& folder, size_t count) {
    auto file = quadtree::SpoolFile::create(folder + "/images");
    if (!file) return file.error();
    return std::unique_ptr<PreparedImages>(new PreparedImages(std::move(file).value(), count));
}

Status PreparedImages::store(uint32_t image, ChartImage mip) {
    Entry stored{State::kStored, mip.width, mip.height, !mip.alpha.empty(), {}};
    const uint32_t count = mip_count(mip.width, mip.height);
    for (uint32_t level = 0; level < count; ++level) {
        if (level > 0) mip = codec::atlas::downsample(mip);
        mip.rgb.insert(mip.rgb.end(), mip.alpha.begin(), mip.alpha.end());
        const auto range = file_->append(std::as_bytes(std::span(mip.rgb)));
        mip.rgb.resize(mip.rgb.size() - mip.alpha.size());
        if (!range) return range.error();
        stored.offsets.push_back(range->offset);
    }
    const std::lock_guard lock(mutex_);
    entries_[image] = std::move(stored);
    return Done{};
}

void PreparedImages::fail(uint32_t image) {
    const std::lock_guard lock(mutex_);
    entries_[image].state = State::kFailed;
}

PreparedImages::Entry PreparedImages::entry(uint32_t image) const {
    const std::lock_guard lock(mutex_);
    return image < entries_.size() ? entries_[image] : Entry();
}

PreparedImages::State PreparedImages::state(uint32_t image) const {
    return entry(image).state;
}

std::array<uint32_t, 2> PreparedImages::sides(uint32_t image) const {
    const std::lock_guard lock(mutex_);
    return {entries_[image].width, entries_[image].height};
}

bool PreparedImages::has_alpha(uint32_t image) const {
    const std::lock_guard lock(mutex_);
    return image < entries_.size() && entries_[image].alpha;
}

uint32_t PreparedImages::levels(uint32_t image) const {
    const Entry stored = entry(image);
    return mip_count(stored.width, stored.height);
}

uint32_t PreparedImages::level_of_size(uint32_t image, uint64_t texels) const {
    const Entry stored = entry(image);
    uint32_t level = 0;
    while (mip_texels(stored.width, stored.height, level) > texels) ++level;
    return level;
}

Result<ChartImage> PreparedImages::read(uint32_t image, uint32_t level) const {
    const Entry stored = entry(image);
    if (stored.state != State::kStored) return Error{"image was not prepared"};
    level = std::min(level, mip_count(stored.width, stored.height) - 1);
    const uint64_t texels = mip_texels(stored.width, stored.height, level);
    const quadtree::SpoolRange range{stored.offsets[level], (stored.alpha ? 4 : 3) * texels};
    std::vector<std::byte> bytes;
    if (Status status = file_->read(range, bytes); !status) return status.error();
    ChartImage mip{mip_side(stored.width, level), mip_side(stored.height, level), false, false, 0, {}};
    mip.rgb.resize(3 * texels);
    std::memcpy(mip.rgb.data(), bytes.data(), mip.rgb.size());
    if (!stored.alpha) return mip;
    mip.alpha.resize(texels);
    std::memcpy(mip.alpha.data(), bytes.data() + mip.rgb.size(), texels);
    return mip;
}

}  // namespace citystream::tiles::layers
