#include "tiles/layers/facade_painter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/facade/run_grid.h"
#include "tiles/layers/facade_picture.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;

constexpr uint32_t kGreatestPicture = 2048;
constexpr size_t kEntryBytes = 192;  // of a kept picture beside its texels: nodes, list, image

SlotColour slot_colour(const city::CityCatalog& catalog, ImageCache& images, uint32_t material, double texel) {
    SlotColour slot;
    const city::Material& m = catalog.materials[material];
    const auto mean = images.mean_colour(material);
    for (size_t c = 0; c < 3; ++c) slot.flat[c] = srgb_to_linear(mean[c]);
    if (m.image < 0) return slot;
    slot.metres_per_repeat = m.metres_per_repeat > 0 ? static_cast<double>(m.metres_per_repeat) : 1.0;
    if (texel >= slot.metres_per_repeat) return slot;
    const auto whole = images.mip(static_cast<uint32_t>(m.image), 0);
    if (!whole) return slot;
    const uint32_t texels = std::max(whole->width, whole->height);
    uint32_t level = 0;
    while ((texels >> level) > 1 && slot.metres_per_repeat / (texels >> level) < texel) ++level;
    slot.image = images.mip(static_cast<uint32_t>(m.image), level);
    return slot;
}

FacadeFacts facts_of(const RunGrid& map, double texel_metres) {
    FacadeFacts facts;
    facts.width_metres = map.width() * texel_metres;
    facts.height_metres = map.height() * texel_metres;
    const codec::facade::DepthRange depths = map.depths();
    facts.depth_min_mm = static_cast<int16_t>(depths.min_mm);
    facts.depth_max_mm = static_cast<int16_t>(depths.max_mm);
    facts.depth_metres = std::max(std::abs(depths.min_mm), std::abs(depths.max_mm)) * 0.001;
    facts.flat = flat_panels(map, texel_metres);
    for (const uint32_t label : map.labels) facts.slots |= 1U << slot_of(label);
    return facts;
}

uint32_t texels_for(double metres, double texel) {
    return static_cast<uint32_t>(
        std::clamp(std::ceil(metres / texel - 1e-9), 1.0, static_cast<double>(kGreatestPicture)));
}

}  // namespace

double FacadeFacts::flat_loss() const {
    return std::max(depth_metres, flat.error_metres / kReliefWeight);
}

const FacadeFacts& FacadePainter::facts(uint32_t map) {
    {
        const std::lock_guard lock(mutex_);
        const auto found = facts_.find(map);
        if (found != facts_.end()) return found->second;
    }
    const FacadeFacts facts = facts_of(catalog_.facade_maps.map(map), catalog_.facade_maps.texel_metres(map));
    const std::lock_guard lock(mutex_);
    return facts_.emplace(map, facts).first->second;
}

std::shared_ptr<const ChartImage> FacadePainter::picture(uint32_t map, uint32_t palette, double texel) {
    const Key key{map, palette, texel};
    if (auto kept = find(key)) return kept;
    auto painted = std::make_shared<const ChartImage>(paint(key));
    keep(key, painted);
    return painted;
}

std::shared_ptr<const ChartImage> FacadePainter::find(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = pictures_.find(key);
    if (found == pictures_.end()) return nullptr;
    uses_.splice(uses_.begin(), uses_, found->second.use);
    return found->second.picture;
}

void FacadePainter::keep(const Key& key, const std::shared_ptr<const ChartImage>& picture) {
    const std::lock_guard lock(mutex_);
    if (pictures_.count(key) != 0) return;
    uses_.push_front(key);
    pictures_[key] = {picture, uses_.begin()};
    used_ += picture->rgb.size() + kEntryBytes;
    while (used_ > budget_ && uses_.size() > 1) {
        const auto oldest = pictures_.find(uses_.back());
        used_ -= oldest->second.picture->rgb.size() + kEntryBytes;
        pictures_.erase(oldest);
        uses_.pop_back();
    }
}

FacadePainter::PictureSize FacadePainter::picture_size(uint32_t map, double texel) {
    const FacadeFacts& known = facts(map);
    return {texels_for(known.width_metres, texel), texels_for(known.height_metres, texel)};
}

ChartImage FacadePainter::paint(const Key& key) {
    const FacadeFacts& known = facts(key.map);
    const auto [width, height] = picture_size(key.map, key.texel);
    SlotColours slots;
    for (uint32_t slot = 0; slot < slots.size(); ++slot) {
        if ((known.slots >> slot) & 1U)
            slots[slot] = slot_colour(catalog_, images_, catalog_.palettes[key.palette].material[slot], key.texel);
    }
    ChartImage out = paint_facade(catalog_.facade_maps.map(key.map), catalog_.facade_maps.texel_metres(key.map), slots,
                                  width, height);
    out.metres_per_texel = static_cast<float>(std::max(known.width_metres / width, known.height_metres / height));
    return out;
}

std::array<uint8_t, 3> FacadePainter::mean_colour(uint32_t map, uint32_t palette) {
    const uint64_t key = uint64_t{map} << 32 | palette;
    {
        const std::lock_guard lock(mutex_);
        const auto found = means_.find(key);
        if (found != means_.end()) return found->second;
    }
    const ChartImage one = paint({map, palette, std::numeric_limits<double>::infinity()});
    const std::array<uint8_t, 3> mean = {one.rgb[0], one.rgb[1], one.rgb[2]};
    const std::lock_guard lock(mutex_);
    return means_[key] = mean;
}

}  // namespace citystream::tiles::layers
